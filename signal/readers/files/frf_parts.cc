#include "signal/readers/files/frf_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "signal/recording/recording_error.h"
#include "signal/recording/units.h"

namespace rigfit::signal {
namespace {
using Eigen::Index;

RecordingError refused_frf(const FrfPart& part, std::string problem, std::string remedy) {
  return {{part.file, part.line, 0, "", ""}, std::move(problem), std::move(remedy)};
}

/// Place of the point in the list, added when it is new.
Index place(std::vector<MeasuredPoint>& points, const MeasuredPoint& point) {
  const Index at = std::ranges::find(points, point) - points.begin();
  if (at == std::ssize(points)) points.push_back(point);
  return at;
}

void check_lines(const FrfPart& part, const FrfPart& first) {
  const auto& f = part.frequency_hz;
  const Index n = f.size();
  if (!f.allFinite() || f[0] < 0 || !(f.tail(n - 1).array() > f.head(n - 1).array()).all()) {
    throw refused_frf(part, "the frequencies do not rise", "export the FRFs again");
  }
  if (!same_lines(f, first.frequency_hz)) {
    throw refused_frf(part, "has other frequencies than the first FRF",
                      "give functions over the same lines");
  }
  if (part.form != first.form) {
    throw refused_frf(part, "is of another form (receptance, mobility, accelerance) than the first",
                      "convert all FRFs to one form first");
  }
}

}  // namespace

std::optional<FrfUnit> parse_frf_unit(const std::string& text) {
  const auto q = parse_quotient(text, Quantity::force);
  if (!q) return std::nullopt;
  return FrfUnit{q->over.factor / q->under.factor, form_of(q->over.quantity),
                 "(" + q->over.si + ")/" + q->under.si};
}

bool same_lines(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return a.size() == b.size() && a.allFinite() &&
         (a - b).cwiseAbs().maxCoeff() <= 1e-6 * std::max(1e-300, b.cwiseAbs().maxCoeff());
}

FrfSet set_of_parts(const std::vector<FrfPart>& parts) {
  FrfSet set;
  const FrfPart& first = parts.front();
  set.form = first.form;
  std::map<std::pair<Index, Index>, const FrfPart*> placed;
  for (const auto& part : parts) {
    check_lines(part, first);
    const std::pair at(place(set.responses, part.response), place(set.inputs, part.input));
    if (placed.emplace(at, &part).second) continue;
    throw refused_frf(
        part,
        fmt::format("is a second FRF from \"{}\" to \"{}\"", part.input.name, part.response.name),
        "keep one of the two");
  }
  const auto responses = static_cast<Index>(set.responses.size());
  const auto inputs = static_cast<Index>(set.inputs.size());
  for (Index r = 0; r < responses; ++r) {
    for (Index i = 0; i < inputs; ++i) {
      if (placed.contains({r, i})) continue;
      throw refused_frf(
          first,
          fmt::format("no FRF from \"{}\" to \"{}\"", set.inputs[static_cast<std::size_t>(i)].name,
                      set.responses[static_cast<std::size_t>(r)].name),
          "give FRFs of all responses to all inputs");
    }
  }
  const auto note = [&](const char* code, const std::string& message) {
    set.notes.push_back({code, message, ""});
  };
  const Index lines = first.frequency_hz.size();
  const auto is_number = [&](Index line) {
    return std::all_of(parts.begin(), parts.end(),
                       [&](const FrfPart& part) { return std::isfinite(std::abs(part.H[line])); });
  };
  const Index begin = lines > 1 && !is_number(0) ? 1 : 0;
  const Index end = lines > 2 && !is_number(lines - 1) ? lines - 1 : lines;
  if (const Index left = lines - (end - begin); left > 0) {
    note("data_left_out", fmt::format("lines without numbers at the ends are left out: {}", left));
  }
  const Index kept = end - begin, columns = responses * inputs;
  set.frequency_hz = first.frequency_hz.segment(begin, kept);
  set.H.resize(kept, columns);
  for (const auto& [at, part] : placed) {
    set.H.col(set.column(at.first, at.second)) = part->H.segment(begin, kept);
    if (!part->H.segment(begin, kept).allFinite()) {
      throw refused_frf(*part, "an FRF holds values that are no numbers", "export the FRFs again");
    }
  }
  const auto fill = [&](Eigen::VectorXd FrfPart::*values, Eigen::MatrixXd& into,
                        const std::string& what) {
    const auto known = std::count_if(parts.begin(), parts.end(), [&](const FrfPart& part) {
      return (part.*values).size() == lines;
    });
    if (known == 0) return;
    if (known < columns) return note("incomplete", what + " of some FRFs only: left out");
    into.resize(kept, columns);
    for (const auto& [at, part] : placed) {
      into.col(set.column(at.first, at.second)) = (part->*values).segment(begin, kept);
    }
    if (into.allFinite()) return;
    note("not_a_number", what + " holds values that are no numbers: left out");
    into.resize(0, 0);
  };
  fill(&FrfPart::coherence, set.coherence, "coherence");
  fill(&FrfPart::H_std, set.H_std, "standard deviation");
  return set;
}

}  // namespace rigfit::signal
