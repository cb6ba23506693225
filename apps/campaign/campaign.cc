#include "apps/campaign/campaign.h"

#include <stdexcept>
#include <type_traits>

namespace rigfit::apps {

using describe::Option;
using describe::Options;

const char* name_of(ValueOrigin::Kind kind) {
  constexpr const char* kNames[] = {"published", "inferred", "assumed"};
  return kNames[static_cast<std::size_t>(kind)];
}

const std::vector<std::string>& kinds_of_tests() {
  static const std::vector<std::string> kinds{"bending", "axial", "decay", "modal", "tension"};
  return kinds;
}

TensionTest::TensionTest() { cable.length_m = cable.mass_per_length = {0, 0}; }

std::optional<model::ModePlane> plane_named(const std::string& word) {
  if (word == "in") return model::ModePlane::in;
  if (word == "out") return model::ModePlane::out;
  return std::nullopt;
}

void BendingTest::complete() {
  if (!beam()) return;
  test.ends = ends == "pinned"       ? ident::BeamEnds::pinned
              : ends == "cantilever" ? ident::BeamEnds::cantilever
                                     : ident::BeamEnds::clamped;
  // Without tension these have no effect.
  test.tension_zero_std_N = test.tension_calibration_std = test.clamp_stiffness_Nm_rad = 0;
}

void TensionTest::complete() {
  const bool whole =
      std::ranges::all_of(orders, [](double order) { return order == std::round(order); });
  if (!whole || (!orders.empty() && orders.size() != frequencies_hz.size())) {
    throw std::invalid_argument(
        fmt::format("the orders {} are not one whole number for each of {} frequencies",
                    fmt::join(orders, " "), frequencies_hz.size()));
  }
  if (EI_Nm2) cable.EI_Nm2 = {*EI_Nm2, EI_std_Nm2};
  if (EA_N) cable.EA_N = {*EA_N, EA_std_N};
  options.ends = ident::cable_ends(ends);
  for (std::size_t i = 0; i < frequencies_hz.size(); ++i) {
    auto& mode = modes.emplace_back();
    mode.frequency_hz.value = frequencies_hz[i];
    if (frequency_std_hz > 0) mode.frequency_hz.std = frequency_std_hz;
    if (i < orders.size()) mode.order = static_cast<int>(std::lround(orders[i]));
    mode.plane = plane;
  }
}

Options keys_of(Campaign& c) {
  return {option("title", c.title, "Title of the report").required(),
          option("source", c.source, "Where published values come from"),
          option("description", c.description, "Below the title")};
}

Options keys_of(ReportDetails& d) {
  return {option("author", d.author, "On the first page, as the following"),
          option("organisation", d.organisation, ""),
          option("client", d.client, ""),
          option("project", d.project, ""),
          option("revision", d.revision, ""),
          option("date", d.date, "Such as 2026-05-18; default: the day the page is made")};
}

Options keys_of(ident::StrandGeometry& s) {
  return {option("youngs_modulus", s.youngs_modulus_Pa, "Of the wires", "Pa").required().positive(),
          option("wires", s.elements, "Their number").required().within(1, 100000),
          option("wire_diameter", s.element_diameter_m, "", "m").required().positive(),
          option("diameter", s.strand_diameter_m, "Of the strand", "m").required().positive()};
}

Options keys_of(RecordingGroup& g) {
  return {option("files", g.files, "Files, or patterns with * and ?").required(),
          option("tension", g.tension_N, "Of the cable while recorded", "N").positive(),
          option("length", g.length_m, "Of the cable, in axial tests", "m").positive(),
          option("load", g.load, "The scene's load, where one test strikes several places"),
          option("synthetic", g.synthetic, "Made by a virtual laboratory")};
}

Options channel_keys_of(BendingTest& t) {
  return {
      option("tension", t.channels.tension, "Name of the channel; default: by name and quantity"),
      option("load", t.channels.load, ""), option("deflection", t.channels.deflection, "")};
}

Options keys_of(BendingTest& t) {
  auto& test = t.test;
  Options keys{option("span", test.span_m.value,
                      "Clear length between clamps or supports; cantilever: to the load", "m")
                   .required()
                   .positive(),
               option("tension", t.tension_N,
                      "0: a beam without tension, by dead weights or a testing machine", "N")
                   .from_zero()
                   .excludes("table"),
               option("rectangle", t.section.rectangle_m,
                      "Its section, width and height (along the load): gives the modulus", "m")
                   .count(2)
                   .positive()
                   .needs("tension")
                   .excludes("diameter")
                   .excludes("second_moment"),
               option("diameter", t.section.diameter_m, "Of a round and solid section", "m")
                   .positive()
                   .needs("tension")
                   .excludes("second_moment")};
  for (auto& key :
       {option("ends", t.ends, "Of the beam: loaded at mid-span, or at the end of a cantilever")
            .one_of({"clamped", "pinned", "cantilever"}),
        option("second_moment", t.section.second_moment_m4, "Of area, about the axis of bending",
               "m4")
            .positive(),
        option("section_std", t.section.relative_std, "Of the second moment, relative")
            .from_zero()}) {
    keys.push_back(Option(key).needs("tension"));
  }
  for (auto& key :
       {option("span_std", test.span_m.std, "Standard uncertainty of the span", "m"),
        option("tension_zero_std", test.tension_zero_std_N, "Of the tension cell's zero", "N"),
        option("clamp_stiffness", test.clamp_stiffness_Nm_rad,
               "1 over the standard uncertainty of each clamp's flexibility; default: rigid",
               "N m/rad"),
        option("tension_calibration_std", test.tension_calibration_std, "Relative"),
        option("load_calibration_std", test.load_calibration_std, "Relative"),
        option("deflection_calibration_std", test.deflection_calibration_std, "Relative")}) {
    keys.push_back(Option(key).from_zero().needs("recording"));
  }
  return keys;
}

Options keys_of(AxialTest& t) {
  auto& s = t.setup;
  auto frame = option("frame_stiffness", s.frame_stiffness_N_m.value,
                      "What gives way above the cable; not given: one length gives EA from below "
                      "only",
                      "N/m")
                   .positive()
                   .one_of({"rigid"});
  frame.set = [&s](const describe::Json& given) {
    s.frame_stated = true;  // a rigid one has no number
    if (given.is_number()) s.frame_stiffness_N_m.value = given;
  };
  return {
      option("mass", s.mass_kg.value, "Hung mass, adapter and clamp included", "kg")
          .required()
          .positive(),
      option("mass_std", s.mass_kg.std, "Standard uncertainty", "kg").from_zero(),
      option("mass_per_length", s.mass_per_length_kg_m.value, "Of the cable", "kg/m").from_zero(),
      option("mass_per_length_std", s.mass_per_length_kg_m.std, "Standard uncertainty", "kg/m")
          .from_zero(),
      option("length_std", s.length_std_m, "Of each length; not given: EA has no uncertainty", "m")
          .from_zero(),
      option("adapter_stiffness", s.adapter_stiffness_N_m.value,
             "In series below the cable; default: rigid", "N/m")
          .from_zero(),
      option("adapter_stiffness_std", s.adapter_stiffness_N_m.std, "Standard uncertainty", "N/m")
          .from_zero(),
      std::move(frame),
      option("frame_stiffness_std", s.frame_stiffness_N_m.std, "Standard uncertainty", "N/m")
          .from_zero(),
      option("compliance_std", s.series_compliance_std_m_N,
             "Of what else gives way in series; 0: rigid", "m/N")
          .from_zero(),
      option("catalogue_EA", s.catalogue_EA_N, "To compare with", "N").from_zero(),
      option("channel", t.channel, "Of the tension (or motion); default: the only one"),
      band("band", t.band_low_hz, t.band_high_hz, "Where the axial frequency is")};
}

Options keys_of(DecayTest& t) {
  return {
      option("channels", t.options.channels, "Default: all"),
      band("band", t.options.decay.band_low_hz, t.options.decay.band_high_hz,
           "Where decays are looked for"),
      option("load", t.load, "The scene's release or impact, simulated and laid over the records")
          .needs("scene")};
}

Options keys_of(ident::SceneUse& use) {
  return {
      option("tension_of", use.tension_of, "The scene's parameters that take a state's tension"),
      option("EI_of", use.EI_of, "Those that take EI of the bending test at that tension"),
      option("EA_of", use.EA_of, "Those that take the axial test's EA"),
      option("damping_of", use.damping_of, "Those that take its damping ratio")};
}

Options keys_of(ModalTest& t) {
  auto& options = t.options;
  auto& hammer = options.hammer;
  Options keys{option("planes", t.planes, "What the test sees: in and out of the plane of gravity")
                   .one_of({"in", "out"})};
  for (auto& key : {option("responses", hammer.responses, "Channels; default: every other one"),
                    option("band", hammer.impact.hits.band_hz, "Of the modes"),
                    option("ambient", options.ambient, "Motion under unknown forces: no hammer"),
                    option("reference", options.references,
                           "Channels that stay in place in all set-ups; default: what they share")
                        .needs("ambient")}) {
    keys.push_back(Option(key).needs("recording"));
  }
  for (auto& key :
       {option("force", hammer.force, "Channel of the hammer; required with recordings of hits"),
        option("load", t.load, "The place struck: the scene's load; default: its only impact"),
        option("direction", t.direction_xyz, "Struck and measured along it").count(3),
        choice("estimator", hammer.impact.estimator, {"h1", "h2", "hv"},
               "Noise on responses, on the force, on both"),
        option("force_window", hammer.impact.force_window_s,
               "Force kept from the pulse's start; default: three pulse lengths", "s")
            .positive(),
        option("exponential_window", hammer.impact.exponential_end_level,
               "Level of the window at the end of the block; its damping is taken off again")
            .within(1e-12, 0.999),
        option("max_order", options.modal.lscf.max_order, "Of the stabilisation diagram")
            .within(2, 400)}) {
    keys.push_back(Option(key).needs("recording").excludes("ambient"));
  }
  return keys;
}

Options keys_of(TensionTest& t) {
  auto& cable = t.cable;
  auto& assignment = t.options.assignment;
  return {
      option("length", cable.length_m.value, "Between the ends, along the chord", "m")
          .required()
          .positive(),
      option("length_std", cable.length_m.std, "Standard uncertainty", "m").from_zero(),
      option("mass_per_length", cable.mass_per_length.value, "Of the cable", "kg/m")
          .required()
          .positive(),
      option("mass_per_length_std", cable.mass_per_length.std, "Standard uncertainty", "kg/m")
          .from_zero(),
      choice("mass_of", cable.mass_reference, {"unknown", "installed", "unstretched"},
             "State of the cable that the mass per length is of"),
      option("EI", t.EI_Nm2, "Flexural rigidity; default: fitted", "N m2").positive(),
      option("EI_std", t.EI_std_Nm2, "Standard uncertainty", "N m2").from_zero(),
      option("EA", t.EA_N, "Axial rigidity; default: a strain of 0.001", "N").positive(),
      option("EA_std", t.EA_std_N, "Standard uncertainty", "N").from_zero(),
      option("inclination", cable.inclination_deg, "Of the chord: 0 horizontal, 90 a hanger",
             "degrees")
          .within(-90, 90),
      option("ends", t.ends, "Kinds of ends")
          .one_of({ident::kCableEndsWords.begin(), ident::kCableEndsWords.end()}),
      choice("plane", t.plane, {"any", "in", "out"}, "The motion that was measured"),
      option("missed", assignment.missed, "Probability that a mode was not seen")
          .within(0.001, 0.9),
      option("false", assignment.false_mode, "Probability that a mode is none of the cable's")
          .within(0.001, 0.9),
      option("frequencies", t.frequencies_hz, "Measured frequencies", "Hz").positive(),
      option("frequency_std", t.frequency_std_hz, "Standard uncertainty", "Hz").positive(),
      option("orders", t.orders, "Which modes `frequencies` are: 1 is the first of its plane")
          .positive(),
      option("measured", t.measured, "Table of frequencies, or modes as UFF 55"),
      option("column", t.column, "Of the frequencies in that table").needs("measured"),
      option("channels", t.channels, "Of the recordings; default: all").needs("recording"),
      band("band", t.band_low_hz, t.band_high_hz, "Where modes are looked for").needs("recording")};
}

Options reference_keys_of(CampaignTest& t) {
  return {option("name", t.reference_name, "What they are"),
          option("EA", t.EA_N, "Of an axial test", "N").positive(),
          option("damping_ratio", t.damping_ratio, "Of an axial test").positive(),
          option("tension", t.tension_N, "Of a tension test", "N").positive()};
}

Options keys_of(CampaignFit& f) {
  return {
      option("title", f.title, "Default: its name"),
      option("tests", f.test_names, "Modal tests that have a scene").required(),
      option("predicts", f.predicted_names, "Decay tests that it has not seen and is laid over"),
      option("hold_out", f.options.hold_out, "Predict each state from the others"),
      option("model_std", f.options.model_relative_std, "Of the model, relative in frequency")
          .from_zero(),
      option("starts", f.options.starts, "Searches").within(1, 1000),
      option("reference_name", f.reference_name, "What `reference` is")};
}

Options keys_of(FitParameter& p) {
  return {option("name", p.name, "A parameter of the scene, or of people").required(),
          option("of", p.targets, "The scene's parameters that share the value"),
          option("factors", p.factors, "From the value to each of them; default: 1"),
          option("per_state", p.per_state, "A value in every state"),
          option("start", p.start, "Default: the scene's value"),
          option("prior", p.prior_value, "From an earlier test").needs("prior_std"),
          option("prior_std", p.prior_std, "Its standard uncertainty").positive().needs("prior"),
          option("prior_std_percent", p.prior_std_percent,
                 "Instead: of each state's own value, such as a load cell's reading", "%")
              .from_zero()
              .excludes("prior"),
          option("low", p.low, "Bound"),
          option("high", p.high, "Bound"),
          option("reference", p.reference, "An earlier value, shown beside the one found")};
}

namespace {

/// The value of a key, of its kind; throws DocumentError for another one.
describe::Json value_of(document::TomlTable& table, const Option& key) {
  using document::Bound;
  switch (key.kind) {
    case describe::Kind::flag:
      return table.boolean_or(key.name, false);
    case describe::Kind::integer:
      return table.integer_or(key.name, static_cast<int>(key.lowest), static_cast<int>(key.highest),
                              0);
    case describe::Kind::number:
      if (!key.words.empty() && table.is_string(key.name)) return table.string(key.name);
      return table.number(key.name, Bound::any, key.unit);
    case describe::Kind::numbers:
      return table.numbers(key.name, 1, SIZE_MAX, Bound::any, key.unit);
    case describe::Kind::text:
      return table.string(key.name);
    case describe::Kind::texts:
      break;
  }
  return table.strings(key.name);
}

}  // namespace

void read_keys(document::TomlTable& table, const Options& keys, const char* help) {
  describe::Json given = describe::Json::object();
  for (const auto& key : keys) {
    if (table.has(key.name)) given[key.name] = value_of(table, key);
  }
  const auto misfit =
      describe::fill(keys, given, [&](const std::string& other) { return table.has(other); });
  if (!misfit) return;
  throw table.error(misfit->name, misfit->problem, fmt::format("see `rigfit help {}`", help));
}

Options campaign_keys() {
  // The options show the defaults of what they are not going to fill.
  const auto keys_of_a = [](auto one) { return keys_of(one); };
  Campaign campaign;
  BendingTest bending;
  CampaignTest test;
  std::string other;
  Options all;
  std::string heading;
  const auto also = [&](const std::string& name, const std::string& meaning) {
    all.push_back(option(name, other, meaning).group(heading));
  };
  const auto add = [&](const std::string& title, const Options& keys,
                       const std::string& before = "") {
    heading = title;
    for (Option key : keys) {
      key.name.insert(0, before);
      all.push_back(key.group(heading));
    }
  };
  add("top level", keys_of(campaign));
  add("[report]", keys_of(campaign.report));
  add("[strand]: bounds on EI", keys_of_a(ident::StrandGeometry()));
  add("[[scene]]: a model of the rig", {});
  also("name, file", "Required");
  also("published.PARAMETER", "How the value is known; or inferred.PARAMETER, assumed.PARAMETER");
  add("[[test]]", {});
  also("name, kind", fmt::format("\"{}\"; required", fmt::join(kinds_of_tests(), "\", \"")));
  also("title", "Default: its name");
  add("[[test]] kind = \"bending\"", keys_of(bending));
  add(heading, channel_keys_of(bending), "channels.");
  add("[[test]] kind = \"axial\"", keys_of_a(AxialTest()));
  add("[[test]] kind = \"decay\"", keys_of_a(DecayTest()));
  add("[[test]] kind = \"modal\"", keys_of_a(ModalTest()));
  add("[[test]] kind = \"decay\", \"modal\"", {});
  also("scene", "Name of the scene that stands for the rig");
  also("sensors.CHANNEL", "The scene's sensor, where names differ");
  add(heading, keys_of_a(ident::SceneUse()));
  add("[[test]] kind = \"tension\"", keys_of_a(TensionTest()));
  add("[test.table]: results instead of recordings (bending, modal)", {});
  also("file", "Required");
  also("tension, EI, measured", "Names of columns");
  also("models.LABEL", "Column of a published model's frequencies");
  add("[test.reference]: values as known otherwise", reference_keys_of(test));
  add("[[test.recording]]", keys_of_a(RecordingGroup()));
  also("sample_rate_hz, time_unit, decimal, separator, format, variables, channel",
       "As in a sidecar (rigfit help sidecar)");
  add("[[fit]]: of scenes to modal tests", {});
  also("name", "Required");
  add(heading, keys_of_a(CampaignFit()));
  add("[[fit.parameter]]", keys_of_a(FitParameter()));
  return all;
}

}  // namespace rigfit::apps
