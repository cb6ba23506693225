// The JSON result of `rigfit update` as what another verb starts from.

#include "apps/cli/verbs/all.h"
#include "ident/predict/scene_prediction.h"
#include "model/scene/scene_error.h"

namespace rigfit::apps {
namespace {

constexpr const char* kWrittenBy = "rigfit update SCENE ... --json FIT.json";

/// What the fit ended with.
void tell_outcome(const Json& json, const std::string& path, bool accepted, VerbContext& context) {
  for (const auto& warning : json.value("warnings", Json::array())) {
    const std::string code = warning.value("code", "");
    if (code != "model_ruled_out" && code != "not_converged" && code != "mode_unpaired") continue;
    context.warn("fit_" + code, "in the fit: " + warning.value("message", ""), path);
  }
  const double exit_code = number_in(json.value("error", Json::object()), "exit_code");
  if (exit_code >= 4 && !accepted) {
    context.refuse("fit_refused",
                   fmt::format("mend the fit, or take it with --accept-fit: it ended with exit "
                               "code {:g}, and its parameters need not be those of the rig",
                               exit_code),
                   path);
  }
  const Json answers = json.value("alternatives", Json::array());
  if (!answers.empty() && number_in(answers.at(0), "weight") < 0.9) {
    context.warn("not_decided",
                 "the fit has several answers; the prediction is of the heaviest one", path);
  }
}

}  // namespace

ident::FittedParameters read_fit(const std::string& path, bool accepted, VerbContext& context,
                                 std::vector<std::string>* lines) {
  const Json json = read_document(path, "parameters", kWrittenBy);
  try {
    ident::FittedParameters fitted;
    std::vector<std::size_t> kept;  // rows whose parameters are identified
    std::vector<double> std;
    const auto& rows = json["parameters"];
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const auto name = rows[i].at("name").get<std::string>();
      const auto value = rows[i].at("value").get<double>();
      if (const double known = number_in(rows[i], "std"); std::isfinite(known)) {
        fitted.parameters.push_back({name, value});
        std.push_back(known);
        kept.push_back(i);
      } else {
        context.warn("parameter_without_std",
                     name + " is not identified by the fit: the scene's own value stays", path);
      }
      const double low = number_in(rows[i], "low"), high = number_in(rows[i], "high");
      if (lines != nullptr && std::isfinite(low) && std::isfinite(high)) {
        lines->push_back(
            fmt::format("{} = {:.6g}, 95 %: {:.6g} to {:.6g}", name, value, low, high));
      }
    }
    const Json given = json.value("correlation", Json());
    const auto n = static_cast<Eigen::Index>(kept.size());
    Eigen::MatrixXd correlation = Eigen::MatrixXd::Identity(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto row = kept[static_cast<std::size_t>(i)];
      for (Eigen::Index j = 0; j < n && !given.is_null(); ++j) {
        if (i != j) correlation(i, j) = given.at(row).at(kept[static_cast<std::size_t>(j)]);
      }
      // What the fit's own inputs do to its parameters, from their budgets.
      for (const auto& term : rows[row].value("budget", Json::array())) {
        const double change = number_in(term, "change");
        if (std::isfinite(change)) ident::add_effect(term.value("source", ""), i, change, fitted);
      }
    }
    const auto stds = Eigen::Map<const Eigen::VectorXd>(std.data(), n).asDiagonal();
    fitted.covariance = stds * correlation * stds;
    tell_outcome(json, path, accepted, context);
    return fitted;
  } catch (const Json::exception& error) {
    throw model::SceneError({path, 0, 0, "parameters"},
                            std::string("is no whole result of a fit: ") + error.what(),
                            std::string("give what ") + kWrittenBy + " wrote");
  }
}

}  // namespace rigfit::apps
