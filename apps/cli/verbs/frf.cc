// rigfit frf: hammer hits to averaged FRFs with coherence and error bars.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>

#include "apps/cli/verbs/all.h"
#include "apps/cli/verbs/impact_command.h"
#include "apps/describe/digits.h"
#include "apps/results/modal_json.h"
#include "signal/estimation/robust.h"
#include "signal/numerics/numbers.h"
#include "signal/writers/write_uff.h"

namespace rigfit::apps {
namespace {
using Eigen::Index;

struct FrfCommand {
  ImpactCommand impact;
  std::string out, csv;
};

/// Median over the lines of the usable band of |H_std / H| of one response.
double relative_error(const signal::FrfSet& frfs, Index column, double low, double high) {
  std::vector<double> ratios;
  if (frfs.H_std.size() == 0) return signal::kNaN;
  for (Index k = 0; k < frfs.frequency_hz.size(); ++k) {
    const double f = frfs.frequency_hz[k], size = std::abs(frfs.H(k, column));
    if (f > low && f <= high && size > 0) ratios.push_back(frfs.H_std(k, column) / size);
  }
  return ratios.empty() ? signal::kNaN : signal::median(ratios);
}

double mean_coherence(const signal::FrfSet& frfs, Index column, double low, double high) {
  double sum = 0, count = 0;
  if (frfs.coherence.size() == 0) return signal::kNaN;
  for (Index k = 0; k < frfs.frequency_hz.size(); ++k) {
    if (frfs.frequency_hz[k] <= low || frfs.frequency_hz[k] > high) continue;
    sum += frfs.coherence(k, column), ++count;
  }
  return count > 0 ? sum / count : signal::kNaN;
}

std::string csv_quoted(const std::string& name) {
  std::string text = "\"";
  for (const char c : name) text += c == '"' ? std::string("\"\"") : std::string(1, c);
  return text + "\"";
}

/// One line a frequency: then, per response and point struck, real, imaginary, std of each,
/// coherence.
std::string csv_of(const signal::FrfSet& frfs) {
  fmt::memory_buffer text;
  auto out = std::back_inserter(text);
  fmt::format_to(out, "frequency (Hz)");
  const std::string unit = frfs.unit.empty() ? "" : " (" + frfs.unit + ")";
  for (const auto& response : frfs.responses) {
    for (const auto& input : frfs.inputs) {
      const std::string name = frfs.inputs.size() > 1
                                   ? fmt::format("{} by {}", response.name, input.name)
                                   : response.name;
      for (const char* what : {" real", " imag", " std"}) {
        fmt::format_to(out, ",{}", csv_quoted(fmt::format("{}{}{}", name, what, unit)));
      }
      fmt::format_to(out, ",{}", csv_quoted(name + " coherence"));
    }
  }
  fmt::format_to(out, "\n");
  for (Index k = 0; k < frfs.frequency_hz.size(); ++k) {
    fmt::format_to(out, "{:.10g}", frfs.frequency_hz[k]);
    for (Index c = 0; c < frfs.H.cols(); ++c) {
      fmt::format_to(out, ",{:.9g},{:.9g},", frfs.H(k, c).real(), frfs.H(k, c).imag());
      if (frfs.H_std.size() > 0) fmt::format_to(out, "{:.4g}", frfs.H_std(k, c));
      fmt::format_to(out, ",");
      if (frfs.coherence.size() > 0) fmt::format_to(out, "{:.6g}", frfs.coherence(k, c));
    }
    fmt::format_to(out, "\n");
  }
  return fmt::to_string(text);
}

/// Standard deviation of the force at rest before a hit; NaN where there is too little of it.
double noise_before(const ImpactRun& run, std::size_t point, const signal::Hit& hit) {
  constexpr Index kFewest = 8;
  const Index first = std::max<Index>(0, hit.block_first), n = hit.pulse_first - first;
  const auto& channels = run.places[point].recordings[hit.recording].channels;
  const auto force = std::find_if(channels.begin(), channels.end(), [&](const auto& channel) {
    return channel.name == run.test.force;
  });
  if (n < kFewest || force == channels.end()) return signal::kNaN;
  const auto rest = force->samples.segment(first, n).array();
  return std::sqrt((rest - rest.mean()).square().sum() / static_cast<double>(n - 1));
}

void print_hits(std::ostream& out, const ImpactRun& run, std::size_t point) {
  const signal::ImpactTest& test = run.test.tests[point];
  const std::string& unit = run.test.force_unit;
  const std::string& name = run.places[point].name;
  if (!name.empty()) out << "struck at " << name << '\n';
  out << fmt::format("{:>4} {:>12} {:>14} {:>10}  {}\n", "hit", "time, s",
                     unit.empty() ? "peak" : "peak, " + unit, "pulse, ms", "");
  for (std::size_t i = 0; i < test.search.hits.size(); ++i) {
    const signal::Hit& hit = test.search.hits[i];
    // A sample is known to lie within its step: a rectangle's standard uncertainty.
    const double step_std = 1 / (std::sqrt(12.0) * test.search.sample_rate_hz);
    out << fmt::format("{:>4} {:>12} {:>14} {:>10}  {}\n", i + 1,
                       value_digits(hit.time_s, step_std),
                       value_digits(hit.peak, noise_before(run, point, hit)),
                       value_digits(1e3 * hit.pulse_duration_s, 1e3 * step_std),
                       hit.accepted ? (hit.reason.empty() ? "accepted" : "kept: " + hit.reason)
                                    : "rejected: " + hit.reason);
  }
  if (test.frfs.averages == 0) return;
  out << fmt::format(
      "{} of {} hits averaged, blocks of {} samples ({:.4g} Hz a line), force usable to {:.4g} "
      "Hz\n",
      test.frfs.averages, test.search.hits.size(), test.search.block_samples,
      test.search.sample_rate_hz / static_cast<double>(test.search.block_samples), test.usable_hz);
}

void print(std::ostream& out, const ImpactRun& run) {
  const ident::HammerTest& test = run.test;
  for (std::size_t p = 0; p < test.tests.size(); ++p) print_hits(out, run, p);
  for (const signal::DrivingPoint& driving : test.driving_points) {
    out << fmt::format("driving point {}: {}\n",
                       test.frfs.responses[static_cast<std::size_t>(driving.response)].name,
                       name_of(driving.check.verdict));
  }
  for (const signal::ReciprocityCheck& pair : test.reciprocity) {
    out << fmt::format("{} and {}: FRFs both ways differ by {:.2g} % (noise {:.2g} %)\n", pair.a,
                       pair.b, 100 * pair.difference, 100 * pair.from_noise);
  }
}

Json driving_json(const signal::DrivingPointCheck& check) {
  return {{"verdict", name_of(check.verdict)},
          {"wrong_sign_share", check.wrong_sign_share},
          {"resonances", check.resonances},
          {"missing_antiresonances", check.missing_antiresonances}};
}

Json run_frf(const FrfCommand& options, VerbContext& context) {
  const auto tested = run_impact_test(context, options.impact);
  const ImpactRun& run = *tested;
  if (context.at_hand) {
    context.at_hand->frfs = std::make_shared<signal::FrfSet>(run.test.frfs);
  }
  const ident::HammerTest& hammer = run.test;
  const signal::FrfSet& frfs = hammer.frfs;
  const bool roving = !options.impact.struck.empty();
  print(context.out, run);
  if (context.plots) {
    const auto& asked = options.impact.band;
    draw_hammer_test(*context.plots, {&run.places, &hammer, frfs, asked.empty() ? 0 : asked[0],
                                      asked.empty() ? hammer.usable_hz : asked[1]});
  }

  // Blocks are as long for all points; a point without hits has none.
  const auto measured = std::find_if(hammer.tests.begin(), hammer.tests.end(),
                                     [](const auto& test) { return !test.search.hits.empty(); });
  const signal::HitSearch& search = measured->search;
  Json result{{"hits", hits_json(run)},
              {"averages", frfs.averages},
              {"frequency_resolution_hz",
               search.sample_rate_hz / static_cast<double>(search.block_samples)},
              {"sample_rate_hz", search.sample_rate_hz},
              {"block_samples", search.block_samples},
              {"exponential_decay_rate_1_s", frfs.exponential_decay_rate_1_s},
              {"frf_form", name_of(frfs.form)},
              {"units", frfs.unit},
              {"amplitudes", frfs.averages > 0 && hammer.amplitudes},
              {"estimator", options.impact.estimator},
              {"force", hammer.force}};
  if (frfs.averages == 0) return result;
  result["usable_hz"] = hammer.usable_hz;
  result["force_window"] = force_window_json(hammer);
  double incoherence = 0;
  for (const signal::ImpactTest& test : hammer.tests) {
    incoherence = std::max(incoherence, test.incoherence);
  }
  result["incoherent_part"] = frfs.averages > 2 ? Json(incoherence) : Json(nullptr);
  const double low = options.impact.band.empty() ? 0 : options.impact.band[0];
  const double high = options.impact.band.empty() ? hammer.usable_hz : options.impact.band[1];
  Json responses = Json::array();
  for (std::size_t r = 0; r < frfs.responses.size(); ++r) {
    for (std::size_t i = 0; i < frfs.inputs.size(); ++i) {
      const Index c = frfs.column(static_cast<Index>(r), static_cast<Index>(i));
      Json one{{"name", frfs.responses[r].name},
               {"mean_coherence", mean_coherence(frfs, c, low, high)},
               {"median_relative_error", relative_error(frfs, c, low, high)}};
      if (roving) one["struck"] = frfs.inputs[i].name;
      responses.push_back(std::move(one));
    }
  }
  result["responses"] = std::move(responses);
  if (roving) {
    Json points = Json::array(), pairs = Json::array(), struck = Json::array();
    for (const auto& input : frfs.inputs) struck.push_back(input.name);
    for (const signal::DrivingPoint& driving : hammer.driving_points) {
      Json one = driving_json(driving.check);
      one["point"] = frfs.inputs[static_cast<std::size_t>(driving.input)].name;
      points.push_back(std::move(one));
    }
    for (const signal::ReciprocityCheck& pair : hammer.reciprocity) {
      pairs.push_back({{"points", {pair.a, pair.b}},
                       {"difference", pair.difference},
                       {"from_noise", pair.from_noise}});
    }
    result["struck"] = std::move(struck);
    result["driving_points"] = std::move(points);
    result["reciprocity"] = std::move(pairs);
  } else if (!hammer.driving_points.empty()) {
    result["driving_point"] = driving_json(hammer.driving_points.front().check);
  }
  if (!options.out.empty()) {
    context.write(options.out, signal::uff_text(frfs, signal::UffEncoding::binary));
    result["out"] = options.out;
    context.out << "FRFs, coherence and error bars: " << options.out << '\n';
  }
  if (!options.csv.empty()) {
    context.write(options.csv, csv_of(frfs));
    result["csv"] = options.csv;
    context.out << "the same as a table: " << options.csv << '\n';
  }
  return result;
}

describe::Options options_of(FrfCommand& c) {
  using describe::option;
  describe::Options options{
      option("FILE", c.impact.files, "Recordings (CSV, LVM, UFF 58): continuous or one a hit")
          .required()};
  for (auto& one : options_of(c.impact)) options.push_back(std::move(one));
  for (auto& one : options) one.is_required |= one.name == "--force";
  for (auto& one : {option("--out", c.out, "FRFs with coherence and error bars as UFF 58")
                        .writes()
                        .type("F.uff"),
                    option("--csv", c.csv, "FRFs with standard deviations and coherence as CSV")
                        .writes()
                        .type("F")}) {
    options.push_back(one);
  }
  return options;
}

}  // namespace

Verb frf_verb() {
  Verb verb = verb_of<FrfCommand>(
      "frf", "Hammer hits found and judged, averaged FRFs with coherence and error bars",
      "Example:\n  rigfit frf hits.csv --force hammer --response a1 a2 --out frf.uff --json -\n"
      "  rigfit frf p1.csv p2.csv --struck a1 a2 --force hammer --response a1 a2 --out frf.uff\n"
      "Exit code 4: no hit can be used; the hits and their reasons are given all the same.",
      [](const FrfCommand& c, VerbContext& context) { return run_frf(c, context); });
  verb.draws = true;
  verb.reads = true;
  return verb;
}

}  // namespace rigfit::apps
