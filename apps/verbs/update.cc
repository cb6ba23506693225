// rigfit update: a scene's uncertain parameters fitted to measured modes.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <optional>

#include "apps/json_document.h"
#include "apps/measured_modes.h"
#include "apps/output_file.h"
#include "apps/progress.h"
#include "apps/stiffness_table.h"
#include "apps/verbs/all.h"
#include "ident/model_update.h"
#include "model/read_scene.h"

namespace rigfit::apps {
namespace {

struct Options {
  std::vector<std::string> scenes, measured, free, priors, planes;
  std::string column, stiffness, out;
  bool hold_out = false;
  int monte_carlo = 0, starts = 4;
  double start_spread = 3, assumed_std = 0.01, model_std = 0;
};

double number_of(const std::string& text, const std::string& option) {
  try {
    std::size_t used = 0;
    const double value = std::stod(text, &used);
    if (used == text.size() && std::isfinite(value)) return value;
  } catch (const std::exception&) {
  }
  throw UsageError(fmt::format("{}: \"{}\" is no number", option, text));
}

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0;;) {
    const auto end = text.find(at, begin);
    parts.push_back(text.substr(begin, end - begin));
    if (end == std::string::npos) return parts;
    begin = end + 1;
  }
}

// "name", "name@each", "name=target,target,-target", any with "@each" at its end.
ident::FreeParameter free_parameter(std::string text) {
  ident::FreeParameter parameter;
  if (text.ends_with("@each")) {
    parameter.per_state = true;
    text.resize(text.size() - 5);
  }
  const auto equals = text.find('=');
  parameter.name = text.substr(0, equals);
  if (equals != std::string::npos) {
    for (std::string target : split(text.substr(equals + 1), ',')) {
      const bool minus = target.starts_with("-");
      if (minus) target.erase(0, 1);
      if (target.empty()) throw UsageError("--free: an empty name in \"" + text + "\"");
      parameter.targets.push_back(target);
      parameter.factors.push_back(minus ? -1 : 1);
    }
  }
  if (parameter.name.empty()) throw UsageError("--free: a parameter without a name");
  return parameter;
}

std::vector<ident::FreeParameter> free_parameters(const Options& options,
                                                  const model::Scene& scene) {
  std::vector<ident::FreeParameter> free;
  for (const auto& text : options.free) free.push_back(free_parameter(text));
  if (free.empty()) {  // what is least known of a rig: its bending stiffnesses
    for (const auto& member : scene.members) {
      const std::string name = member.name + (member.EI[0] == member.EI[1] ? ".EI" : ".EI_z");
      free.push_back(free_parameter(name));
    }
  }
  for (const auto& text : options.priors) {
    const auto equals = text.find('=');
    const auto values = equals == std::string::npos ? std::vector<std::string>{}
                                                    : split(text.substr(equals + 1), ',');
    if (values.size() != 2) {
      throw UsageError("--prior: write NAME=VALUE,STD, not \"" + text + "\"");
    }
    const std::string name = text.substr(0, equals);
    auto known = std::find_if(free.begin(), free.end(),
                              [&](const auto& parameter) { return parameter.name == name; });
    if (known == free.end()) throw UsageError("--prior: " + name + " is not among --free");
    known->prior =
        signal::Estimate{number_of(values[0], "--prior"), number_of(values[1], "--prior")};
    if (!(known->prior->std > 0)) throw UsageError("--prior: the uncertainty must be positive");
  }
  return free;
}

struct States {
  std::vector<ident::UpdateState> states;
  std::vector<std::string> scene_files;  // by state
  std::vector<std::optional<double>> tension;
};

std::optional<model::ModePlane> plane_of(const Options& options, std::size_t file) {
  if (options.planes.empty()) return std::nullopt;
  const auto& word = options.planes[options.planes.size() == 1 ? 0 : file];
  if (word == "in") return model::ModePlane::in;
  if (word == "out") return model::ModePlane::out;
  return std::nullopt;  // "any"
}

States read_states(const Options& options, VerbContext& context) {
  if (options.scenes.size() > 1 && options.scenes.size() != options.measured.size()) {
    throw UsageError("with several scenes, give one --measured for each, in their order");
  }
  if (options.planes.size() > 1 && options.planes.size() != options.measured.size()) {
    throw UsageError("--plane: one for all, or one for each --measured");
  }
  std::optional<ResultTable> stiffness;
  if (!options.stiffness.empty()) {
    context.input(options.stiffness);
    stiffness = read_result_table(options.stiffness);
  }
  States result;
  for (std::size_t f = 0; f < options.measured.size(); ++f) {
    const auto& scene_file = options.scenes[options.scenes.size() > 1 ? f : 0];
    context.input(scene_file);
    context.input(options.measured[f]);
    const model::Scene scene = model::read_scene(scene_file);
    std::vector<std::string> sensors;
    for (const auto& sensor : scene.sensors) sensors.push_back(sensor.name);
    const auto rows =
        read_measured_modes(options.measured[f], options.column, plane_of(options, f), sensors);
    for (const auto& row : rows) {
      std::size_t s = 0;
      while (s < result.states.size() &&
             (result.scene_files[s] != scene_file || result.tension[s] != row.tension_N)) {
        ++s;
      }
      if (s == result.states.size()) {
        ident::UpdateState state;
        state.scene = scene;
        state.name = options.scenes.size() > 1 ? scene.title : "";
        if (row.tension_N) {
          state.name += fmt::format("{}{:g} N", state.name.empty() ? "" : ", ", *row.tension_N);
          for (const auto& member : scene.members) {
            if (member.kind != model::Member::Kind::cable) continue;
            model::set_parameter(state.scene, member.name + ".tension", *row.tension_N);
            if (!stiffness) continue;
            model::set_parameter(state.scene, member.name + ".EI",
                                 stiffness_at(*stiffness, *row.tension_N, context));
          }
        }
        result.states.push_back(std::move(state));
        result.scene_files.push_back(scene_file);
        result.tension.push_back(row.tension_N);
      }
      result.states[s].measured.push_back(row.mode);
    }
  }
  return result;
}

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json pair_json(const ident::UpdatedPair& pair, const States& states) {
  Json json{{"state", states.states[static_cast<std::size_t>(pair.state)].name},
            {"measured_hz", pair.measured_hz},
            {"model_hz", pair.model_hz},
            {"relative_error", pair.relative_error},
            {"plane", model::name_of(pair.plane)},
            {"order", pair.order + 1}};
  if (std::isfinite(pair.mac)) json["mac"] = pair.mac;
  if (std::isfinite(pair.measured_damping)) {
    json["measured_damping_ratio"] = pair.measured_damping;
    json["model_damping_ratio"] = number(pair.model_damping);
  }
  if (pair.cross_plane) json["leakage"] = true;
  return json;
}

Json pairs_json(const ident::UpdateResult& result, const States& states) {
  Json pairs = Json::array();
  for (const auto& pair : result.pairs) pairs.push_back(pair_json(pair, states));
  for (const auto& lone : result.unpaired) {
    pairs.push_back({{"state", states.states[static_cast<std::size_t>(lone.state)].name},
                     {"measured_hz", lone.measured ? Json(lone.frequency_hz) : Json(nullptr)},
                     {"model_hz", lone.measured ? Json(nullptr) : Json(lone.frequency_hz)},
                     {"relative_error", nullptr},
                     {"reason", lone.reason}});
  }
  return pairs;
}

void print(std::ostream& out, const ident::UpdateResult& result, const States& states) {
  out << fmt::format("{:<34} {:>12} {:>12} {:>10}\n", "parameter", "start", "value", "std");
  for (const auto& p : result.parameters) {
    out << fmt::format("{:<34} {:>12.5g} {:>12.5g} {:>10}\n", p.name, p.start, p.value,
                       p.identifiable ? fmt::format("{:.2g}", p.std) : "not known");
  }
  out << fmt::format("{:<24} {:>12} {:>12} {:>9}  {}\n", "state", "measured, Hz", "model, Hz",
                     "error", "mode");
  for (const auto& pair : result.pairs) {
    out << fmt::format("{:<24} {:>12.4f} {:>12.4f} {:>7.2f} %  {} {}{}\n",
                       states.states[static_cast<std::size_t>(pair.state)].name, pair.measured_hz,
                       pair.model_hz, 100 * pair.relative_error, model::name_of(pair.plane),
                       pair.order + 1, pair.cross_plane ? " (leakage, not fitted)" : "");
  }
  for (const auto& lone : result.unpaired) {
    const auto& name = states.states[static_cast<std::size_t>(lone.state)].name;
    const std::string hz = fmt::format("{:.4f}", lone.frequency_hz);
    out << fmt::format("{:<24} {:>12} {:>12} {:>9}  {}\n", name, lone.measured ? hz : "-",
                       lone.measured ? "-" : hz, "unpaired", lone.reason);
  }
  out << fmt::format("rms of the paired errors: {:.2f} % before, {:.2f} % fitted\n",
                     100 * result.rms_relative_error_before, 100 * result.rms_relative_error);
}

Json hold_out_json(const States& states, const std::vector<ident::FreeParameter>& free,
                   const ident::UpdateOptions& options, VerbContext& context) {
  Json json = Json::array();
  const auto held = ident::hold_out_each(states.states, free, options);
  context.out << fmt::format("{:<24} {:>10} {:>12} {:>12}\n", "held out", "before", "others fitted",
                             "predicted");
  for (const auto& one : held) {
    const auto& name = states.states[static_cast<std::size_t>(one.state)].name;
    context.out << fmt::format("{:<24} {:>8.2f} % {:>10.2f} % {:>10.2f} %\n", name,
                               100 * one.rms_before, 100 * one.rms_fitted, 100 * one.rms_predicted);
    Json pairs = Json::array();
    for (const auto& pair : one.pairs) pairs.push_back(pair_json(pair, states));
    json.push_back({{"state", name},
                    {"status", ident::name_of(one.status)},
                    {"rms_relative_error_before", number(one.rms_before)},
                    {"rms_relative_error_fitted", number(one.rms_fitted)},
                    {"rms_relative_error_predicted", number(one.rms_predicted)},
                    {"pairs", std::move(pairs)}});
  }
  return json;
}

Json write_scenes(const Options& options, const States& states, const ident::UpdateResult& result,
                  VerbContext& context) {
  Json files = Json::array();
  for (std::size_t s = 0; s < result.scenes.size(); ++s) {
    std::filesystem::path path =
        options.out.empty()
            ? std::filesystem::path(std::filesystem::path(states.scene_files[s]).stem().string() +
                                    ".updated.toml")
            : std::filesystem::path(options.out);
    if (result.scenes.size() > 1) {
      const std::string tension =
          states.tension[s] ? fmt::format("-{:g}N", *states.tension[s]) : "";
      const std::string number = options.scenes.size() > 1 ? fmt::format("-{}", s + 1) : "";
      path.replace_filename(path.stem().string() + number + tension + path.extension().string());
    }
    write_whole_file(path, model::scene_text(result.scenes[s]));
    context.out << "updated scene: " << path.string() << '\n';
    files.push_back(path.string());
  }
  return files;
}

Json run_update(VerbContext& context, const Options& options) {
  const States states = read_states(options, context);
  const auto free = free_parameters(options, states.states.front().scene);
  ident::UpdateOptions update;
  update.assumed_relative_std = options.assumed_std;
  update.model_relative_std = options.model_std;
  update.starts = options.starts;
  update.start_spread = options.start_spread;
  update.seed = context.seed;
  update.threads = context.threads;
  const auto result = ident::update_model(states.states, free, update);
  if (result.status == ident::UpdateStatus::no_model) throw NotConverged(result.message);

  print(context.out, result, states);
  if (result.status == ident::UpdateStatus::not_converged) {
    context.warn("not_converged", result.message);
    context.exit_code = ExitCode::not_converged;
  } else if (!result.message.empty()) {
    context.warn("doubtful", result.message);
  }
  for (const auto& open : result.open) context.refuse("not_identifiable", open);
  for (const auto& p : result.parameters) {
    if (p.at_bound) context.warn("at_bound", "ended at its bound", p.name);
    if (p.identifiable && !std::isfinite(p.std_from_data)) {
      context.warn("from_prior", "is known from its prior only, not from these data", p.name);
    }
  }
  if (result.starts > 1 && result.starts_agreeing < result.starts) {
    context.warn("starts_differ", fmt::format("{} of {} starts ended in this answer, the others in "
                                              "worse ones",
                                              result.starts_agreeing, result.starts));
  }

  Json json{{"status", ident::name_of(result.status)}, {"parameters", Json::array()}};
  for (const auto& p : result.parameters) {
    json["parameters"].push_back({{"name", p.name},
                                  {"start", p.start},
                                  {"value", p.value},
                                  {"std", number(p.std)},
                                  {"identifiable", p.identifiable},
                                  {"std_from_data", number(p.std_from_data)},
                                  {"at_bound", p.at_bound}});
  }
  Json correlation = Json::array();
  const auto& known = result.identifiability;
  for (Eigen::Index i = 0; i < known.correlation.rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index j = 0; j < known.correlation.cols(); ++j) {
      row.push_back(number(known.correlation(i, j)));
    }
    correlation.push_back(std::move(row));
  }
  json["correlation"] = std::move(correlation);
  json["rank"] = known.rank;
  json["condition"] = number(known.condition);
  json["not_identifiable"] = result.open;
  json["pairs"] = pairs_json(result, states);
  json["rms_relative_error"] = number(result.rms_relative_error);
  json["rms_relative_error_before"] = number(result.rms_relative_error_before);
  json["chi_squared"] = result.chi_squared;
  json["degrees_of_freedom"] = result.degrees_of_freedom;
  json["coverage_factor"] = result.coverage_factor;
  json["starts"] = result.starts;
  json["starts_agreeing"] = result.starts_agreeing;
  json["model_evaluations"] = result.model_evaluations;
  if (options.hold_out) {
    if (states.states.size() < 2) {
      throw UsageError("--hold-out needs several states: a tension_N column or several scenes");
    }
    json["hold_out"] = hold_out_json(states, free, update, context);
  }
  if (options.monte_carlo > 0) {
    Progress progress("Monte Carlo", options.monte_carlo, context.quiet);
    const auto study = ident::update_monte_carlo(result, states.states, free, update,
                                                 options.monte_carlo, [&] { progress.advance(); });
    Json rows = Json::array();
    for (Eigen::Index j = 0; j < study.mean.size(); ++j) {
      rows.push_back({{"name", result.parameters[static_cast<std::size_t>(j)].name},
                      {"mean", study.mean[j]},
                      {"std", study.std[j]},
                      {"low", study.low[j]},
                      {"high", study.high[j]}});
    }
    json["monte_carlo"] = {
        {"samples", study.samples}, {"failed", study.failed}, {"parameters", std::move(rows)}};
    context.out << fmt::format("Monte Carlo: {} samples, {} failed\n", study.samples, study.failed);
  }
  json["scenes"] = write_scenes(options, states, result, context);
  return json;
}

}  // namespace

void add_update(CLI::App& program, Verbs& verbs) {
  const auto options = std::make_shared<Options>();
  CLI::App* verb =
      program.add_subcommand("update", "A scene's uncertain parameters fitted to measured modes");
  verb->add_option("SCENE", options->scenes, "Scene files (several: one for each --measured)")
      ->required()
      ->check(CLI::ExistingFile);
  verb->add_option("--measured", options->measured,
                   "Tables of measured modes: frequency_hz, and where known std, damping_ratio, "
                   "damping_std, plane, tension_N (a state each), shape:<sensor>")
      ->required()
      ->check(CLI::ExistingFile);
  verb->add_option("--free", options->free,
                   "Scene parameters to fit: NAME, NAME=TARGET,-TARGET (several that share a "
                   "value), NAME@each (one value a state). Default: every member's EI");
  verb->add_option("--prior", options->priors,
                   "NAME=VALUE,STD of a free parameter, from other tests");
  verb->add_option("--column", options->column, "Name of the frequency column");
  verb->add_option("--plane", options->planes, "Plane of each --measured: in, out or any")
      ->check(CLI::IsMember({"in", "out", "any"}));
  verb->add_option("--stiffness", options->stiffness,
                   "Table of tension_N, EI_Nm2: the cables' EI in each state")
      ->check(CLI::ExistingFile);
  verb->add_option("--assumed-std", options->assumed_std,
                   "Relative standard uncertainty of frequencies that come without one")
      ->check(CLI::Range(1e-9, 1.0))
      ->capture_default_str();
  verb->add_option("--model-std", options->model_std,
                   "Relative error in frequency that the model itself is allowed")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  verb->add_option("--starts", options->starts, "Starts, the first at the scene's own values")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  verb->add_option("--start-spread", options->start_spread,
                   "Factor by which the other starts are off at most")
      ->check(CLI::Range(1.0, 100.0))
      ->capture_default_str();
  verb->add_flag("--hold-out", options->hold_out,
                 "Also leave out each state in turn and predict it from the others");
  verb->add_option("--monte-carlo", options->monte_carlo, "Refits of data drawn anew")
      ->check(CLI::Range(0, 1000000));
  verb->add_option("--out", options->out,
                   "Updated scene (default: SCENE's name with .updated.toml, in this folder)");
  verb->footer(
      "Example:\n"
      "  rigfit update testdata/jalali2021/scenes/beam.toml \\\n"
      "    --measured testdata/jalali2021/table2_beam_frequencies.csv --column bond_graph_Hz \\\n"
      "    --plane in --free beam.EI_z tip.mass --out beam.updated.toml --json fit.json");
  verbs.push_back(
      {verb, [options](VerbContext& context) { return run_update(context, *options); }});
}

}  // namespace rigfit::apps
