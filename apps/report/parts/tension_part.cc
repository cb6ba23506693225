#include "apps/report/parts/parts.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "apps/report/drawing/html_text.h"
#include "apps/report/figures/figures.h"
#include "apps/report/page/shaded_tables.h"
#include "apps/results/tension_result.h"
#include "ident/statistics/probability_text.h"

namespace rigfit::apps {
namespace {

ReportTable ends_table(const std::string& id, const ident::TensionResult& r) {
  ReportTable table;
  table.id = id + "-ends";
  table.caption =
      "Tension at mid-span by kind of ends; the result is the average by weight. p: probability of "
      "a larger misfit if the model were right.";
  table.columns = {{"ends", {}, false},
                   {"weight", {}, true},
                   {"tension, N", Origin::modelled},
                   {"95 %, N", Origin::modelled},
                   {"EI, N m²", Origin::modelled},
                   {"chi-square", {}, true},
                   {"degrees of freedom", {}, true},
                   {"p", {}, true}};
  for (const auto& one : r.candidates) {
    if (!one.solved) {
      table.rows.push_back({ident::name_of(one.ends), "0", one.message, "", "", "", "", ""});
      continue;
    }
    table.rows.push_back(
        {ident::name_of(one.ends), fmt::format("{:.3f}", one.weight),
         Cell(shown_estimate(one.tension_N.value, one.tension_N.std), Origin::modelled),
         fmt::format("{} to {}", shown_bound(one.low, one.tension_N.std),
                     shown_bound(one.high, one.tension_N.std)),
         one.EI_Nm2.std > 0 ? shown_estimate(one.EI_Nm2.value, one.EI_Nm2.std)
                            : shown(one.EI_Nm2.value, 3),
         std::isfinite(one.fit.chi2) ? shown(one.fit.chi2, 3) : std::string(),
         fmt::format("{:g}", one.fit.degrees_of_freedom),
         std::isfinite(one.fit.p_value) ? ident::probability_text(one.fit.p_value)
                                        : std::string()});
  }
  return table;
}

ReportTable modes_table(const std::string& id, const ident::TensionResult& r) {
  ReportTable table;
  table.id = id + "-modes";
  table.caption = fmt::format("Measured frequencies and those of the model, {} ends.",
                              ident::name_of(r.candidates.front().ends));
  table.columns = {{"order", {}, true},
                   {"plane", {}, false},
                   {"measured, Hz", Origin::measured},
                   {"model, Hz", Origin::modelled},
                   {"model over test, %", {}, true}};
  for (const auto& mode : r.candidates.front().modes) {
    const bool known = std::isfinite(mode.measured_std_hz);
    const Cell measured(
        known ? shown_estimate(mode.measured_hz, mode.measured_std_hz) : shown(mode.measured_hz, 5),
        Origin::measured);
    if (mode.order == 0 || !std::isfinite(mode.model_hz)) {
      table.rows.push_back({"", "", measured, "none of the cable's", ""});
      continue;
    }
    table.rows.push_back({fmt::format("{}", mode.order), model::name_of(mode.plane), measured,
                          Cell(shown(mode.model_hz, 5), Origin::modelled),
                          fmt::format("{:+.3f}", 100 * mode.relative_error)});
  }
  return table;
}

ReportTable formulas_table(const std::string& id, const ident::TensionResult& r) {
  ReportTable table;
  table.id = id + "-formulas";
  table.caption =
      "What formulas of the literature give from the lowest mode alone, beside the model.";
  table.columns = {{"formula", {}, false},
                   {"tension, N", Origin::published_model},
                   {"over the result, %", {}, true}};
  const auto add = [&](const char* name, double value) {
    if (!std::isfinite(value)) {
      table.rows.push_back({name, "does not apply", ""});
      return;
    }
    table.rows.push_back({name, Cell(shown(value, 5), Origin::published_model),
                          fmt::format("{:+.2f}", 100 * (value / r.tension_N.value - 1))});
  };
  add("string", r.formulas.string_N);
  add("pinned beam", r.formulas.pinned_beam_N);
  add("clamped beam", r.formulas.clamped_beam_N);
  add("Zui, Shinke and Namita", r.formulas.zui_N);
  return table;
}

void answer(ReportPart& part, const CampaignTest& test, const ident::TensionResult& r) {
  Answer answer;
  answer.key = test.name + "/tension";
  answer.quantity = "Cable tension at mid-span";
  answer.how = fmt::format("from {} frequencies, {} ends", r.candidates.front().modes.size(),
                           ident::name_of(r.candidates.front().ends));
  answer.unit = "N";
  answer.value = r.tension_N.value;
  answer.std = r.tension_N.std;
  answer.low = r.low;
  answer.high = r.high;
  answer.determined = r.decided;
  if (test.tension_N) {
    answer.reference = *test.tension_N;
    answer.reference_name = test.reference_name;
  }
  answer.origin = test.recordings.empty() ? Origin::measured : test.recordings.front().origin();
  answer.anchor = part.id;
  part.summary.push_back(
      {SummaryItem::Kind::result, test.title + ": tension",
       fmt::format("{} N (95 %: {} to {})", shown_estimate(r.tension_N.value, r.tension_N.std),
                   shown_bound(r.low, r.tension_N.std), shown_bound(r.high, r.tension_N.std)),
       answer.origin, part.id});
  part.answers.push_back(std::move(answer));
}

void show_result(ReportPart& part, const CampaignTest& test, const ident::TensionResult& r) {
  for (auto& plot : tension_plots(test.name, r)) part.blocks.push_back(std::move(plot));
  part.blocks.push_back(ends_table(test.name, r));
  part.blocks.push_back(modes_table(test.name, r));
  part.blocks.push_back(formulas_table(test.name, r));
  Shares shares{"tension", {}};
  for (const auto& term : r.budget) {
    if (std::isfinite(term.std)) shares.parts.emplace_back(term.source, term.std * term.std);
  }
  if (!shares.parts.empty()) {
    part.blocks.push_back(share_table(
        test.name + "-budget",
        "Where the uncertainty of the tension comes from: shares of its variance.", {shares}));
  }
  part.blocks.push_back(Paragraph{fmt::format(
      "Along the cable: {} N at the first end, {} N at the second; sag {} m. Irvine's parameter "
      "{}, L √(T / EI) = {}.",
      shown(r.start_N, 5), shown(r.end_N, 5), shown(r.sag_m, 3), shown(r.irvine_parameter, 2),
      shown(r.bending_parameter, 3))});
  part.brief = {test.name + "-frequencies", test.name + "-ends"};
  answer(part, test, r);
}

class TensionPart : public TestPart {
 public:
  explicit TensionPart(const CampaignTest& test)
      : test_(test), inputs_(test.as<TensionTest>().inputs) {
    part_.id = test.name;
    part_.title = test.title;
    part_.json_key = "tension";
    part_.json["test"] = test.name;
  }

  void read(const FileRead& file_read) override {
    part_.blocks.push_back(Paragraph{
        "The natural frequencies of a cable give its tension. Which mode each frequency is, "
        "bending stiffness, ends and sag are found with it."});
    if (test_.recordings.empty()) return;
    auto loaded = load_recordings(test_.recordings, file_read);
    for (const auto& entry : loaded) {
      part_.inputs.insert(part_.inputs.end(), entry.inputs.begin(), entry.inputs.end());
    }
    add_recordings(part_, test_, loaded);
    for (auto& entry : loaded) {
      if (entry.recording) inputs_.recordings.push_back({entry.file, std::move(*entry.recording)});
    }
  }

  void add_to(ident::CampaignInputs& inputs) override {
    index_ = inputs.tension.size();
    inputs.tension.push_back(std::move(inputs_));
  }

  std::vector<ReportPart> show(ident::CampaignResult& campaign) override {
    const auto& found = campaign.tension[index_];
    for (const auto& f : found.result.findings) {
      const std::string where = f.where.empty() ? test_.name : f.where;
      if (f.refused) {
        refuse(part_, f.code, f.message, where);
      } else {
        part_.warnings.push_back({f.code, f.message, where, false});
      }
    }
    if (found.result.tension.solved) {
      part_.json.update(tension_json(found));
      show_result(part_, test_, found.result.tension);
    }
    return {std::move(part_)};
  }

 private:
  const CampaignTest& test_;
  ident::TensionInputs inputs_;
  std::size_t index_ = 0;
  ReportPart part_;
};

}  // namespace

std::unique_ptr<TestPart> tension_part(const CampaignTest& test) {
  return std::make_unique<TensionPart>(test);
}

}  // namespace rigfit::apps
