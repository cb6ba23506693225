#include "ident/update/model_update.h"

#include <fmt/format.h>

#include "ident/statistics/uncertainty.h"

namespace rigfit::ident {
namespace {

// A model that is off by more in its FRFs is another structure's.
constexpr double kFrfErrorRuledOut = 0.03;
// The model's shape holds less than half of the measured one's power.
constexpr double kLeastMac = 0.5;

std::string percent(double ratio) {
  return std::isfinite(ratio) ? fmt::format("{:.2f} %", 100 * ratio) : "-";
}

}  // namespace

std::string UpdateFit::text() const {
  std::string all =
      fmt::format("chi-square {:.4g} on {:.4g} degrees of freedom", chi2, degrees_of_freedom);
  if (std::isfinite(p_value)) all += ", probability " + probability_text(p_value);
  if (!stated) all += ", with assumed uncertainties";
  if (!stated && rms_error > 0) {
    all += fmt::format(", frequencies off by {} rms and {} at most", percent(rms_error),
                       percent(worst_error));
  }
  if (model_std > 0) {
    all += fmt::format("; error of the model in frequency {}", percent(model_std));
  }
  if (frf_model_std > 0) {
    all += fmt::format("; error of the model {} of the FRFs", percent(frf_model_std));
  }
  return all;
}

std::vector<std::string> alternative_texts(const UpdateResult& result) {
  std::vector<std::string> texts;
  for (std::size_t k = 1; k < result.alternatives.size(); ++k) {
    const auto& one = result.alternatives[k];
    std::string values;
    for (const auto& p : one.parameters) {
      values += fmt::format("{}{} {:.4g}", values.empty() ? "" : ", ", p.name, p.value);
    }
    texts.push_back(
        fmt::format("weight {:.3f}: {}; rms {}, {} modes that the tests should have seen",
                    one.weight, values, percent(one.rms_relative_error),
                    std::ranges::count_if(one.unpaired, &UpdatedPair::missing)));
  }
  return texts;
}

std::vector<Finding> fit_findings(const UpdateResult& result) {
  std::vector<Finding> findings;
  if (result.status == UpdateStatus::no_model) return findings;
  const auto warn = [&](const char* code, std::string message, const std::string& where = "") {
    findings.push_back({code, std::move(message), where});
  };
  const auto refuse = [&](const char* code, std::string message) {
    findings.push_back({code, std::move(message), "", true});
  };
  if (result.fit.ruled_out()) {
    warn("model_ruled_out",
         "Check end conditions, masses, lengths, priors, pairs and stated uncertainties: the data "
         "rule this model out (" +
             result.fit.text() + "), and the intervals hold only as far as its error is random");
  }
  if (result.fit.frf_model_std > kFrfErrorRuledOut) {
    refuse(
        "model_ruled_out",
        fmt::format("Check the scene, the units and the places of hammer and sensors: the model "
                    "misses the FRFs by {} in every line beyond their noise, more than the {} up "
                    "to which parameters are given",
                    percent(result.fit.frf_model_std), percent(kFrfErrorRuledOut)));
  }
  std::vector<UpdatedPair> shapes = result.pairs;
  std::erase_if(shapes, [](const auto& pair) { return pair.cross_plane || std::isnan(pair.mac); });
  const auto worst = std::ranges::min_element(shapes, {}, &UpdatedPair::mac);
  if (worst != shapes.end() && worst->mac < kLeastMac) {
    warn("shapes_disagree",
         fmt::format("Check the sensors' names and directions: of {} measured shapes that of "
                     "{:.5g} Hz agrees least with the model's, with a MAC of {:.2f}",
                     shapes.size(), worst->measured_hz, worst->mac),
         worst->state_name);
  }
  if (!result.alternatives.empty() && result.alternatives.front().weight < 0.9) {
    refuse("several_answers",
           fmt::format("Give more modes, their planes or shapes, or a prior: the data support {} "
                       "answers, the heaviest with a weight of {:.2f} (see alternatives)",
                       result.alternatives.size(), result.alternatives.front().weight));
  }
  if (!result.message.empty() && result.status != UpdateStatus::not_converged) {
    warn("doubtful", result.message);
  }
  for (const auto& open : result.open) refuse("not_identifiable", open);
  for (const auto& p : result.parameters) {
    if (p.at_bound) warn("at_bound", "Check its bound, at which the fit ended", p.name);
    if (p.identifiable && std::abs(p.segment_shift) > 0.5 * p.std) {
      warn("segments",
           fmt::format("Take more segments, or \"auto\": too few make the value about {:.2g} off, "
                       "which is most of its uncertainty",
                       p.segment_shift),
           p.name);
    }
    if (p.identifiable && !std::isfinite(p.std_from_data)) {
      warn("from_prior", "Add data that depend on it, or hold it: it is known from its prior only",
           p.name);
    }
  }
  return findings;
}

}  // namespace rigfit::ident
