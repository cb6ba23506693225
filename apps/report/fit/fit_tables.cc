#include "apps/report/fit/fit_outcome.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/cli/json_document.h"
#include "apps/report/drawing/html_text.h"
#include "apps/report/page/parameter_words.h"
#include "apps/report/page/shaded_tables.h"
#include "apps/report/parts/parts.h"
#include "apps/results/modal_files.h"
#include "ident/campaign/fit_campaign.h"
#include "signal/modes/mac.h"

namespace rigfit::apps {
namespace {

double rms(const std::vector<ident::UpdatedPair>& pairs, int state) {
  double sum = 0;
  int n = 0;
  for (const auto& pair : pairs) {
    if (pair.state != state || pair.cross_plane) continue;
    sum += pair.relative_error * pair.relative_error;
    ++n;
  }
  return n > 0 ? std::sqrt(sum / n) : std::numeric_limits<double>::quiet_NaN();
}

/// Unit of a free parameter, by the first scene that has it.
std::string unit_of(const FitOutcome& of, const ident::FreeParameter* free) {
  if (!free) return {};
  const auto& name = free->targets.empty() ? free->name : free->targets.front();
  for (const auto& update : of.updates) {
    const auto names = model::parameter_names(update.scene);
    if (std::find(names.begin(), names.end(), name) != names.end()) {
      return parameter_unit(update.scene, name);
    }
  }
  return {};
}

/// The answers that the data support, each with its weight and what decides.
void add_alternatives(ReportPart& part, const FitOutcome& of) {
  ReportTable table;
  table.id = of.fit.name + "-alternatives";
  table.caption =
      "All answers that the data support, by which measured mode is which of the model's.";
  table.columns = {{"weight", Origin::modelled},
                   {"parameters", Origin::modelled},
                   {"rms error", Origin::modelled},
                   {"why", {}, false}};
  const auto texts = ident::alternative_texts(of.result);
  for (std::size_t k = 0; k < of.result.alternatives.size(); ++k) {
    const auto& one = of.result.alternatives[k];
    std::string values;
    for (const auto& parameter : one.parameters) {
      values += (values.empty() ? "" : ", ") + parameter_words(parameter.name) + " " +
                shown(parameter.value, 4);
    }
    table.rows.push_back({fmt::format("{:.3f}", one.weight), values,
                          percent_words(one.rms_relative_error), k == 0 ? "" : texts[k - 1]});
  }
  part.blocks.push_back(std::move(table));
}

/// A parameter as it was found, with its words and as an answer of the report.
struct FoundParameter {
  std::string words;
  Answer answer;
};

FoundParameter found_parameter(const FitOutcome& of, const ident::UpdatedParameter& parameter,
                               const std::string& anchor) {
  const auto spec =
      std::find_if(of.fit.parameters.begin(), of.fit.parameters.end(), [&](const FitParameter& p) {
        return parameter.name == p.free.name || parameter.name.starts_with(p.free.name + " [");
      });
  const bool named = spec != of.fit.parameters.end();
  const auto* free = named ? &spec->free : nullptr;
  const std::string name = free ? free->name : parameter.name;
  const std::string target = free && !free->targets.empty() ? free->targets.front() : name;
  FoundParameter found;
  found.words = parameter_words(name);
  Answer& answer = found.answer;
  answer.key = of.fit.name + "/" + parameter.name;
  answer.quantity = found.words;
  if (parameter.state >= 0) answer.quantity += ", " + of.name_of_state(parameter.state);
  std::size_t modes = 0;
  for (const auto& update : of.updates) modes += update.measured.size();
  answer.how = "fitted to " + counted(modes, "mode");
  answer.unit = unit_of(of, free);
  answer.percent = answer.unit.empty() && shown_in_percent(target);
  answer.value = parameter.value;
  answer.std = parameter.std;
  answer.low = parameter.low;
  answer.high = parameter.high;
  answer.determined = parameter.identifiable && std::isfinite(parameter.std);
  if (named) answer.reference = spec->reference;
  answer.reference_name = of.fit.reference_name;
  answer.anchor = anchor;
  answer.rank = parameter.state < 0 ? 0 : 1;
  // A mass at a node is of the structure that was tested, a stiffness of a member that may stand in
  // several.
  for (const char* end : {".mass", ".x", ".y", ".z"}) {
    answer.of_structure = answer.of_structure || target.ends_with(end);
  }
  for (const std::size_t test : of.fit.tests) {
    if (const auto scene = of.campaign.tests[test].scene) {
      answer.structure = of.campaign.scenes[*scene].name;
    }
  }
  if (!answer.structure.empty()) answer.how += " of the " + answer.structure;
  return found;
}

ReportTable parameter_table(const FitOutcome& of, bool priors) {
  ReportTable table;
  table.id = of.fit.name + "-parameters";
  table.caption = "What was found, ± its standard uncertainty, with 95 % intervals.";
  if (priors) {
    table.caption += " Data alone: the standard uncertainty without what was known before.";
  }
  table.columns = {{"parameter", {}, false},
                   {"state", {}, false},
                   {"start", Origin::modelled},
                   {"found", Origin::modelled},
                   {"95 % interval", Origin::modelled},
                   {"data alone ±", Origin::modelled},
                   {of.fit.reference_name, {}, true},
                   {"remark", {}, false}};
  return table;
}

/// What is taken as exact and moves a parameter by more than a tenth of its standard uncertainty.
ReportTable exact_table(const FitOutcome& of) {
  constexpr double kMatters = 0.1;
  const auto& parameters = of.result.parameters;
  ReportTable table;
  table.id = of.fit.name + "-exact";
  table.caption =
      "Taken as exact: what is neither fitted nor given an uncertainty, and the change of each "
      "parameter when it changes, in standard uncertainties of the parameter.";
  table.columns = {{"input", {}, false}, {"changed by", {}, true}};
  for (const auto& one : parameters) table.columns.push_back({parameter_words(one.name), {}, true});
  for (const auto& input : of.result.exact_inputs) {
    std::vector<Cell> cells{parameter_words(input.name), shown_percent(input.relative_change)};
    bool matters = false;
    for (std::size_t p = 0; p < parameters.size(); ++p) {
      const double stds = input.shift[static_cast<Eigen::Index>(p)] / parameters[p].std;
      matters = matters || std::abs(stds) > kMatters;
      cells.emplace_back(std::isfinite(stds) ? fmt::format("{:+.1f}", stds) : "–");
      cells.back().doubtful = std::abs(stds) > 1;
    }
    if (matters) table.rows.push_back(std::move(cells));
  }
  return table;
}

}  // namespace

std::string percent_words(double ratio) {
  return std::isfinite(ratio) ? shown(100 * ratio, 3) + " %" : std::string("–");
}

void add_parameters(ReportPart& part, const FitOutcome& of) {
  const bool priors = std::any_of(
      of.fit.parameters.begin(), of.fit.parameters.end(), [](const FitParameter& parameter) {
        return parameter.free.prior.has_value() || parameter.free.prior_relative_std > 0;
      });
  ReportTable table = parameter_table(of, priors);
  std::size_t list_index = 0;
  for (const auto& parameter : of.result.parameters) {
    const FoundParameter found = found_parameter(of, parameter, part.id);
    const Answer& answer = found.answer;
    const double scale = answer.percent ? 100 : 1;
    const std::string unit = shown_unit(answer);
    const bool known = parameter.identifiable && std::isfinite(parameter.std);
    std::string remark;
    if (!parameter.identifiable) {
      remark = "not identifiable from these data";
    } else if (!std::isfinite(parameter.std_from_data)) {
      remark = "known from before only, not from these data";
    }
    if (parameter.at_bound) remark += std::string(remark.empty() ? "" : "; ") + "at its bound";
    Cell remark_cell(remark);
    remark_cell.doubtful = !remark.empty();
    table.rows.push_back(
        {unit.empty() ? found.words : found.words + ", " + unit,
         parameter.state < 0 ? "all" : state_words(of.name_of_state(parameter.state)),
         shown(scale * parameter.start, 4),
         Cell(known ? value_words(answer) : shown(scale * parameter.value, 4), Origin::modelled),
         known ? interval_words(answer) : std::string("–"),
         !priors                                  ? ""
         : std::isfinite(parameter.std_from_data) ? shown(scale * parameter.std_from_data, 2)
                                                  : "–",
         answer.reference ? shown(scale * *answer.reference, 4) : std::string(), remark_cell});
    part.json["parameters"][list_index++]["reference"] =
        answer.reference ? Json(*answer.reference) : Json(nullptr);
    part.answers.push_back(answer);
    if (!known || parameter.state >= 0) continue;
    part.summary.push_back({SummaryItem::Kind::result, of.fit.title + ": " + found.words,
                            value_words(answer) + (unit.empty() ? "" : " " + unit) +
                                fmt::format(" (95 %: {})", interval_words(answer)) +
                                (answer.reference ? fmt::format("; {} {}", of.fit.reference_name,
                                                                shown(scale * *answer.reference, 4))
                                                  : ""),
                            Origin::modelled, part.id});
  }
  part.blocks.push_back(std::move(table));
  part.blocks.push_back(
      Paragraph{"Fit: " + ident::fit_text(of.result.fit) + ".",
                of.result.fit.ruled_out() ? Paragraph::Kind::note : Paragraph::Kind::plain});
  if (auto exact = exact_table(of); !exact.rows.empty()) part.blocks.push_back(std::move(exact));
  if (of.result.alternatives.size() > 1) add_alternatives(part, of);
  if (of.result.starts > 1 && of.result.alternatives.empty()) {
    part.blocks.push_back(Paragraph{
        fmt::format("{} of {} starts, spread widely about the first values, ended in this answer.",
                    of.result.starts_agreeing, of.result.starts),
        of.result.starts_agreeing == of.result.starts ? Paragraph::Kind::plain
                                                      : Paragraph::Kind::note});
  }
}

double add_errors(ReportPart& part, const FitOutcome& of) {
  ReportTable table;
  table.id = of.fit.name + "-errors";
  table.caption = "Root-mean-square relative error in frequency.";
  table.columns = {
      {"state", {}, false}, {"before", Origin::modelled}, {"fitted", Origin::modelled}};
  if (!of.held.empty()) table.columns.push_back({"held out, predicted", Origin::modelled});
  Json list = Json::array();
  for (std::size_t s = 0; s < of.states.size(); ++s) {
    const int state = static_cast<int>(s);
    const double before = rms(of.result.pairs_before, state), after = rms(of.result.pairs, state);
    std::vector<Cell> cells{state_words(of.updates[s].name), percent_words(before),
                            percent_words(after)};
    Json json{{"state", of.updates[s].name},
              {"rms_relative_error_before", json_number(before)},
              {"rms_relative_error", json_number(after)}};
    for (const auto& held : of.held) {
      if (held.state != state) continue;
      cells.emplace_back(held.status == ident::UpdateStatus::converged
                             ? percent_words(held.rms_predicted)
                             : std::string(ident::name_of(held.status)));
      json["rms_relative_error_held_out"] = json_number(held.rms_predicted);
    }
    table.rows.push_back(std::move(cells));
    list.push_back(std::move(json));
  }
  const double held_rms = of.answer.outcome.rms_held_out;
  std::vector<Cell> all{"all", percent_words(of.result.rms_relative_error_before),
                        percent_words(of.result.rms_relative_error)};
  if (!of.held.empty()) all.emplace_back(percent_words(held_rms));
  table.rows.push_back(std::move(all));
  part.json["states"] = std::move(list);
  part.json["rms_relative_error_held_out"] = json_number(held_rms);
  part.blocks.push_back(std::move(table));
  return held_rms;
}

void add_pairs(ReportPart& part, const FitOutcome& of) {
  ReportTable table;
  table.id = of.fit.name + "-pairs";
  table.caption = "Every measured mode and the model's, before and after.";
  table.columns = {{"state", {}, false},
                   {"test, Hz", {}, true},
                   {"mode", {}, false},
                   {"before", Origin::modelled},
                   {"fitted, Hz", Origin::modelled},
                   {"error", Origin::modelled},
                   {"MAC", Origin::modelled},
                   {"remark", {}, false}};
  Json list = Json::array();
  std::string lonely;
  for (std::size_t s = 0; s < of.updates.size(); ++s) {
    const int state = static_cast<int>(s);
    bool first = true;
    for (std::size_t m = 0; m < of.updates[s].measured.size(); ++m) {
      const auto& mode = of.updates[s].measured[m];
      const auto find = [&](const std::vector<ident::UpdatedPair>& pairs) {
        return std::find_if(pairs.begin(), pairs.end(), [&](const auto& pair) {
          return pair.state == state && pair.measured == static_cast<int>(m);
        });
      };
      const auto before = find(of.result.pairs_before), after = find(of.result.pairs);
      const bool was = before != of.result.pairs_before.end(), is = after != of.result.pairs.end();
      Json json{{"state", of.updates[s].name},
                {"measured_hz", mode.frequency_hz.value},
                {"model_hz", is ? Json(after->model_hz) : Json(nullptr)},
                {"relative_error", is ? Json(after->relative_error) : Json(nullptr)},
                {"relative_error_before", was ? Json(before->relative_error) : Json(nullptr)},
                {"mac", is ? json_number(after->mac) : Json(nullptr)},
                {"leakage", is && after->cross_plane}};
      list.push_back(std::move(json));
      Cell remark(
          is ? (after->cross_plane ? "of the other plane: leaked into the test, not fitted" : "")
             : "no mode of the model is near");
      remark.doubtful = !remark.text.empty();
      if (is && !after->cross_plane) {
        part.modes.push_back(
            {"model fitted", Origin::modelled, mode.frequency_hz.value, after->model_hz});
      }
      if (!is) {
        lonely += fmt::format("{}{} Hz ({})", lonely.empty() ? "" : ", ",
                              shown(mode.frequency_hz.value, 5), state_words(of.updates[s].name));
      }
      table.rows.push_back(
          {first ? state_words(of.updates[s].name) : "",
           Cell(std::isfinite(mode.frequency_hz.std)
                    ? shown_estimate(mode.frequency_hz.value, mode.frequency_hz.std)
                    : shown(mode.frequency_hz.value, 4),
                of.origin_of(s)),
           is ? fmt::format("{} {}", model::name_of(after->plane), after->order + 1) : "",
           was ? shown_percent(before->relative_error) : "–", is ? shown(after->model_hz, 5) : "–",
           is ? shown_percent(after->relative_error) : "–",
           is && std::isfinite(after->mac) ? shown(after->mac, 3) : "", remark});
      first = false;
    }
  }
  for (const auto& lone : of.result.unpaired) {
    if (lone.measured) continue;
    list.push_back({{"state", of.name_of_state(lone.state)},
                    {"measured_hz", nullptr},
                    {"model_hz", lone.frequency_hz},
                    {"reason", lone.reason}});
  }
  if (!lonely.empty()) {
    part.warnings.push_back(
        {"unpaired",
         "Check these measured modes: the fitted model has no partner for them and they do not "
         "enter the fit: " +
             lonely,
         of.fit.name, false});
  }
  if (table.rows.size() > 16) table.fold = fmt::format("All {} pairs", table.rows.size());
  part.json["pairs"] = std::move(list);
  part.blocks.push_back(std::move(table));
}

void add_shapes(ReportPart& part, const FitOutcome& of) {
  for (std::size_t s = 0; s < of.states.size(); ++s) {
    if (of.states[s].modal->rig.response.size() < 2) continue;
    double highest = 0;
    for (const auto& mode : of.updates[s].measured) {
      highest = std::max(highest, mode.frequency_hz.value);
    }
    model::ModesOptions options;
    options.band_hz = {{0.0, 1.15 * highest}};
    options.error_estimate = false;
    const auto analysis = model::analyse_modes(of.result.scenes[s], options);
    std::vector<const model::NaturalMode*> columns;
    std::vector<std::string> rows, names;
    const auto plane = of.test_of(s).as<ModalTest>().inputs.setup.plane;
    for (const auto& mode : analysis.modes) {
      if (!(mode.frequency_hz > 0) || (plane && mode.plane != *plane)) continue;
      columns.push_back(&mode);
      names.push_back(shown(mode.frequency_hz, 4) + " Hz");
    }
    Json matrix = Json::array();
    for (const auto& mode : of.updates[s].measured) {
      if (mode.shape.size() == 0) continue;
      rows.push_back(shown(mode.frequency_hz.value, 4) + " Hz");
      Json json = Json::array();
      for (const auto* natural : columns) {
        json.push_back(signal::mac(mode.shape, natural->sensor_shape.cast<std::complex<double>>()));
      }
      matrix.push_back(std::move(json));
    }
    if (rows.empty() || columns.empty()) continue;
    Eigen::MatrixXd values(static_cast<Eigen::Index>(rows.size()),
                           static_cast<Eigen::Index>(columns.size()));
    for (std::size_t i = 0; i < rows.size(); ++i) {
      for (std::size_t j = 0; j < columns.size(); ++j) {
        values(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
            matrix[i][j].get<double>();
      }
    }
    part.blocks.push_back(matrix_table(
        fmt::format("{}-mac-{}", of.fit.name, s + 1),
        fmt::format("MAC of shapes, {}. Rows: measured modes; columns: modes of the fitted model. "
                    "Compared at the {} sensors; 1: the same shape.",
                    state_words(of.updates[s].name), of.states[s].modal->rig.response.size()),
        values, rows, names));
    part.json["mac"].push_back({{"state", of.updates[s].name}, {"matrix", std::move(matrix)}});
    part.files.push_back(
        {fmt::format("uff/{}-model-{}.uff", of.fit.name, file_word(of.updates[s].name)),
         model_mode_file(analysis)});
  }
}

}  // namespace rigfit::apps
