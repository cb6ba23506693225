// rigfit frf: hammer hits to averaged FRFs with coherence and error bars.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>

#include "apps/impact_command.h"
#include "apps/output_file.h"
#include "apps/verbs/all.h"
#include "signal/write_uff.h"

namespace rigfit::apps {
namespace {
using Eigen::Index;

struct Options {
  ImpactCommand impact;
  std::string out, csv;
  std::string encoding = "binary";
};

/// Median over the lines of the usable band of |H_std / H| of one response.
double relative_error(const signal::FrfSet& frfs, Index column, double low, double high) {
  std::vector<double> ratios;
  if (frfs.H_std.size() == 0) return std::numeric_limits<double>::quiet_NaN();
  for (Index k = 0; k < frfs.frequency_hz.size(); ++k) {
    const double f = frfs.frequency_hz[k], size = std::abs(frfs.H(k, column));
    if (f > low && f <= high && size > 0) ratios.push_back(frfs.H_std(k, column) / size);
  }
  if (ratios.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
  std::nth_element(ratios.begin(), middle, ratios.end());
  return *middle;
}

double mean_coherence(const signal::FrfSet& frfs, Index column, double low, double high) {
  double sum = 0, count = 0;
  if (frfs.coherence.size() == 0) return std::numeric_limits<double>::quiet_NaN();
  for (Index k = 0; k < frfs.frequency_hz.size(); ++k) {
    if (frfs.frequency_hz[k] <= low || frfs.frequency_hz[k] > high) continue;
    sum += frfs.coherence(k, column), ++count;
  }
  return count > 0 ? sum / count : std::numeric_limits<double>::quiet_NaN();
}

std::string quoted(const std::string& name) {
  std::string text = "\"";
  for (const char c : name) text += c == '"' ? std::string("\"\"") : std::string(1, c);
  return text + "\"";
}

/// One line a frequency: then, per response, real, imaginary, std of each, coherence.
std::string csv_of(const signal::FrfSet& frfs) {
  fmt::memory_buffer text;
  auto out = std::back_inserter(text);
  fmt::format_to(out, "frequency (Hz)");
  const std::string unit = frfs.unit.empty() ? "" : " (" + frfs.unit + ")";
  for (const auto& response : frfs.responses) {
    for (const char* what : {" real", " imag", " std"}) {
      fmt::format_to(out, ",{}", quoted(response.name + what + unit));
    }
    fmt::format_to(out, ",{}", quoted(response.name + " coherence"));
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

void print(std::ostream& out, const ImpactRun& run) {
  const signal::ImpactTest& test = run.test;
  const std::string unit = run.recordings.front().channel(run.force).unit;
  out << fmt::format("{:>4} {:>12} {:>14} {:>10}  {}\n", "hit", "time, s",
                     unit.empty() ? "peak" : "peak, " + unit, "pulse, ms", "");
  for (std::size_t i = 0; i < test.search.hits.size(); ++i) {
    const signal::Hit& hit = test.search.hits[i];
    out << fmt::format("{:>4} {:>12.4f} {:>14.5g} {:>10.3g}  {}\n", i + 1, hit.time_s, hit.peak,
                       1e3 * hit.pulse_duration_s,
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

Json driving_json(const signal::DrivingPointCheck& check) {
  return {{"verdict", name_of(check.verdict)},
          {"wrong_sign_share", check.wrong_sign_share},
          {"resonances", check.resonances},
          {"missing_antiresonances", check.missing_antiresonances}};
}

Json run_frf(VerbContext& context, const Options& options) {
  const ImpactRun run = run_impact_test(context, options.impact);
  const signal::ImpactTest& test = run.test;
  const signal::FrfSet& frfs = test.frfs;
  print(context.out, run);

  Json result{{"hits", hits_json(run)},
              {"averages", frfs.averages},
              {"frequency_resolution_hz",
               test.search.sample_rate_hz / static_cast<double>(test.search.block_samples)},
              {"sample_rate_hz", test.search.sample_rate_hz},
              {"block_samples", test.search.block_samples},
              {"exponential_decay_rate_1_s", frfs.exponential_decay_rate_1_s},
              {"frf_form", name_of(frfs.form)},
              {"units", frfs.unit},
              {"amplitudes", frfs.averages > 0 && test.amplitudes},
              {"estimator", options.impact.estimator},
              {"force", run.force}};
  if (frfs.averages == 0) return result;
  result["usable_hz"] = test.usable_hz;
  result["incoherent_part"] = frfs.averages > 2 ? Json(test.incoherence) : Json(nullptr);
  const double low = options.impact.band.empty() ? 0 : options.impact.band[0];
  const double high = options.impact.band.empty() ? test.usable_hz : options.impact.band[1];
  Json responses = Json::array();
  for (Index c = 0; c < frfs.H.cols(); ++c) {
    responses.push_back({{"name", frfs.responses[static_cast<std::size_t>(c)].name},
                         {"mean_coherence", mean_coherence(frfs, c, low, high)},
                         {"median_relative_error", relative_error(frfs, c, low, high)}});
  }
  result["responses"] = std::move(responses);
  if (test.driving_point) result["driving_point"] = driving_json(*test.driving_point);
  if (!options.out.empty()) {
    const auto encoding =
        options.encoding == "ascii" ? signal::UffEncoding::ascii : signal::UffEncoding::binary;
    write_whole_file(options.out, signal::uff_text(frfs, encoding));
    result["out"] = options.out;
    context.out << "FRFs, coherence and error bars: " << options.out << '\n';
  }
  if (!options.csv.empty()) {
    write_whole_file(options.csv, csv_of(frfs));
    result["csv"] = options.csv;
    context.out << "the same as a table: " << options.csv << '\n';
  }
  return result;
}

}  // namespace

void add_frf(CLI::App& program, Verbs& verbs) {
  const auto options = std::make_shared<Options>();
  CLI::App* verb = program.add_subcommand(
      "frf", "Hammer hits found and judged, averaged FRFs with coherence and error bars");
  add_impact_options(*verb, options->impact, true);
  verb->add_option("--out", options->out, "FRFs with coherence and error bars as UFF 58")
      ->type_name("F.uff");
  verb->add_option("--encoding", options->encoding, "Of the UFF file")
      ->check(CLI::IsMember({"binary", "ascii"}))
      ->capture_default_str();
  verb->add_option("--csv", options->csv, "FRFs with standard deviations and coherence as CSV")
      ->type_name("F");
  verb->footer(
      "Example:\n  rigfit frf hits.csv --force hammer --response a1 a2 --out frf.uff --json -\n"
      "Exit code 4: no hit can be used; the hits and their reasons are given all the same.");
  verbs.push_back({verb, [options](VerbContext& context) { return run_frf(context, *options); }});
}

}  // namespace rigfit::apps
