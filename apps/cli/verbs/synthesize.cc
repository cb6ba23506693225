// rigfit synthesize: a virtual laboratory. What it writes is synthetic and says so in every file.

#include <random>

#include "apps/campaign_file/bending_files.h"
#include "apps/cli/json_document.h"
#include "apps/cli/output_file.h"
#include "apps/cli/progress.h"
#include "apps/cli/verbs/all.h"
#include "ident/virtual_rig/virtual_bench.h"
#include "ident/virtual_rig/virtual_rig.h"
#include "model/linear/modal_analysis.h"
#include "model/response/response.h"
#include "model/scene/read_scene.h"
#include "model/scene/scene_error.h"
#include "signal/writers/write_csv.h"
#include "signal/writers/write_uff.h"

namespace rigfit::apps {
namespace {

struct SynthesizeOptions {
  std::string scene;
  std::string out;
  std::vector<double> tensions;
  double tension_std = 0;
  std::string stiffness;
  bool uff = false;
  ident::VirtualRigOptions rig;
  ident::VirtualBendingTest bending;  ///< span 0: none
  ident::VirtualAxialTest axial;
  std::vector<double> axial_lengths;
  double axial_length_std = 0;
  int taps = 5;

  SynthesizeOptions() { axial.hung_mass_kg = 2.2, axial.damping_ratio = 0.017; }
};

constexpr double kMostSamples = 5e6;  // per record: some minutes of simulation
namespace fs = std::filesystem;

// The rig as it was set up for one row of tests.
struct State {
  model::Scene scene;
  std::string prefix;        // begins the file names: "T100N-", or nothing
  std::uint64_t stream = 0;  // added to the seed
  std::optional<double> meant_N;
};

/// What is asked for, and the files written so far.
struct Laboratory {
  const SynthesizeOptions& options;
  const model::Scene& scene;
  VerbContext& context;
  std::vector<std::string> files = {};

  void write_text(const std::string& name, const std::string& text) {
    const fs::path path = fs::path(options.out) / name;
    make_output_folder(path.parent_path());
    context.write(path, text);
    files.push_back(path.string());
  }
  /// Returns the file's name: `name` with the extension of its format.
  std::string write(std::string name, const std::string& test, const signal::Recording& recording,
                    bool uff = false) {
    name += uff ? ".uff" : ".csv";
    const std::string data = "synthetic (virtual laboratory)";
    write_text(name, uff ? uff_text(recording, signal::UffEncoding::binary_single,
                                    fmt::format("{}, {}, seed {}", data, scene.title, context.seed))
                         : csv_text(recording, {{"Data", data},
                                                {"Test", test},
                                                {"Scene", scene.title},
                                                {"Seed", std::to_string(context.seed)},
                                                {"Sampling Rate(Hz)",
                                                 fmt::format("{:g}", recording.sample_rate_hz)}}));
    return name;
  }
};

const model::Member& cable_of(const model::Scene& scene, const std::string& file) {
  for (const auto& member : scene.members) {
    if (member.kind == model::Member::Kind::cable) return member;
  }
  throw model::SceneError({file, 0, 0, "member"}, "has no cable to bend or to hang a mass on",
                          "leave out --bending-span and --axial-length");
}

Json truth_of_rig(const model::Scene& scene, const ident::VirtualRigOptions& options) {
  const model::Scene fine = ident::finer_scene(
      ident::scene_with_accelerometers(scene, options.accelerometer_mass_kg), options.finer);
  model::ModesOptions modes;
  modes.count = 12;
  modes.shapes = false;
  const auto analysis = model::analyse_modes(fine, modes);
  if (analysis.equilibrium.status != model::EquilibriumStatus::converged) {
    throw NotConverged("no equilibrium to test: " + analysis.equilibrium.reason);
  }
  Json parameters;
  for (const auto& name : model::parameter_names(scene)) {
    parameters[name] = model::parameter(scene, name);
  }
  return {{"parameters", std::move(parameters)},
          {"segments_times", options.finer},
          {"accelerometer_mass_kg", options.accelerometer_mass_kg},
          {"modes", describe::json_of(analysis.modes)}};
}

// Tests of one state; appends to `records`.
Json synthesize_rig(Laboratory& lab, const State& state, Progress& progress) {
  const auto& options = lab.options;
  const ident::Simulate simulate = [&](const model::Scene& tested, double duration, double rate) {
    model::ResponseOptions response;
    response.sampling.duration_s = duration;
    response.sampling.rate_hz = rate;
    auto result = model::simulate_response(tested, response);
    if (!result.completed) throw NotConverged("virtual rig: " + result.reason);
    return std::move(result.samples);
  };
  const auto records =
      ident::virtual_rig_records(state.scene, options.rig, simulate,
                                 lab.context.seed + state.stream, [&] { progress.advance(); });
  Json list = Json::array();
  for (const auto& record : records) {
    const std::string name = lab.write(
        record.hit > 0 ? fmt::format("rig/{}{}-hit{}", state.prefix, record.load, record.hit)
                       : fmt::format("rig/{}{}", state.prefix, record.load),
        record.hit > 0 ? "hammer" : "release", record.recording, options.uff);
    Json entry{{"file", name}, {"load", record.load}};
    if (record.hit > 0) {
      entry["peak_N"] = record.peak_N;
      entry["double_hit"] = record.double_hit;
      if (record.double_hit) {
        entry["second_peak_N"] = record.second_peak_N;
        entry["second_after_s"] = record.second_after_s;
      }
    }
    list.push_back(std::move(entry));
  }
  return list;
}

Json synthesize_bending(Laboratory& lab, const State& state) {
  const auto& options = lab.options;
  const model::Member& cable = cable_of(state.scene, options.scene);
  ident::VirtualBendingTest test = options.bending;
  test.EI_Nm2 = cable.EI[0];
  test.tension_N = cable.tension.value_or(0);
  test.tension_cell = options.rig.instruments.tension_cell;
  test.load_cell = options.rig.instruments.load_cell;
  test.lvdt = options.rig.instruments.lvdt;
  ident::Random random = ident::random_stream(lab.context.seed + state.stream, 2'000'000);
  const std::string name =
      lab.write(fmt::format("bending/T{:g}N", state.meant_N.value_or(test.tension_N)),
                fmt::format("bending, span {:g} m", test.span_m),
                ident::virtual_bending_record(test, random));
  return {{"file", name},
          {"EI_Nm2", test.EI_Nm2},
          {"span_m", test.span_m},
          {"tension_N", test.tension_N},
          {"friction_load_N", test.friction_load_N},
          {"friction_travel_m", test.friction_travel_m}};
}

Json synthesize_axial(Laboratory& lab) {
  const auto& options = lab.options;
  const model::Member& cable = cable_of(lab.scene, options.scene);
  Json list = Json::array();
  for (std::size_t i = 0; i < options.axial_lengths.size(); ++i) {
    ident::VirtualAxialTest test = options.axial;
    test.EA_N = cable.EA;
    test.mass_per_length_kg_m = cable.mass_per_length;
    ident::Random cut = ident::random_stream(lab.context.seed, 2'900'000 + i);
    test.length_m = options.axial_lengths[i] +
                    options.axial_length_std * std::normal_distribution<double>()(cut);
    test.load_cell = options.rig.instruments.tension_cell;
    const auto truth = ident::axial_truth(test);
    for (int tap = 1; tap <= options.taps; ++tap) {
      ident::Random random =
          ident::random_stream(lab.context.seed, 3'000'000 + 1000 * i + static_cast<unsigned>(tap));
      const std::string name =
          lab.write(fmt::format("axial/L{:g}m-{}", options.axial_lengths[i], tap),
                    fmt::format("axial, length {:g} m, mass {:g} kg", options.axial_lengths[i],
                                test.hung_mass_kg),
                    ident::virtual_axial_record(test, random));
      list.push_back({{"file", name},
                      {"length_m", test.length_m},
                      {"mass_kg", test.hung_mass_kg},
                      {"EA_N", test.EA_N},
                      {"frequency_hz", truth.frequency_hz},
                      {"damping_ratio", truth.damping_ratio}});
    }
  }
  return list;
}

std::vector<State> states_of(const SynthesizeOptions& options, const model::Scene& scene,
                             VerbContext& context) {
  if (options.tensions.empty()) return {{scene, "", 0, std::nullopt}};
  (void)cable_of(scene, options.scene);
  ident::StiffnessCurve stiffness;
  if (!options.stiffness.empty()) stiffness = read_stiffness_curve(options.stiffness, context);
  std::vector<State> states;
  for (const double tension : options.tensions) {
    State state{{}, fmt::format("T{:g}N-", tension), 10'000'019 * states.size(), tension};
    ident::Random random = ident::random_stream(context.seed + state.stream, 4'000'000);
    // Cables that meet pull alike: one error for all of them.
    const double error = options.tension_std * std::normal_distribution<double>()(random);
    state.scene = cables_at(scene, tension, stiffness, options.stiffness, context);
    for (const auto& name : use_of_cables(scene).tension_of) {
      model::set_parameter(state.scene, name, tension * (1 + error));
    }
    states.push_back(std::move(state));
  }
  return states;
}

Json run(SynthesizeOptions& options, VerbContext& context) {
  const model::Scene scene = scene_of(options.scene, context);
  const bool rig = !scene.loads.empty() && !scene.sensors.empty();
  if (!rig && options.bending.span_m <= 0 && options.axial_lengths.empty()) {
    throw UsageError(options.scene +
                     ": nothing to test: give the scene a load and a sensor, or ask for "
                     "--bending-span or --axial-length");
  }
  if (!options.stiffness.empty() && options.tensions.empty()) {
    throw UsageError("--stiffness goes by tension: give --tension");
  }
  if (!(options.rig.record_s * options.rig.sample_rate_hz <= kMostSamples)) {
    throw UsageError("more than 5 million samples a record: lower --rate or --record");
  }
  const auto states = states_of(options, scene, context);
  make_output_folder(options.out);
  Laboratory lab{options, scene, context};
  Json truth{{"data", "synthetic"},
             {"scene", scene.title},
             {"command", repeat_command(context)},
             {"seed", context.seed}};
  if (rig) {
    long total = 0;
    for (const auto& load : scene.loads) {
      total += load.kind == model::Load::Kind::impact ? options.rig.hits : 1;
    }
    Progress progress("Virtual rig", total * static_cast<long>(states.size()), context.quiet);
    Json tested = Json::array();
    for (const auto& state : states) {
      Json entry = truth_of_rig(state.scene, options.rig);
      if (state.meant_N) entry["tension_meant_N"] = *state.meant_N;
      entry["records"] = synthesize_rig(lab, state, progress);
      tested.push_back(std::move(entry));
    }
    truth["rig"] = std::move(tested);
  }
  if (options.bending.span_m > 0) {
    truth["bending"] = Json::array();
    for (const auto& state : states) {
      truth["bending"].push_back(synthesize_bending(lab, state));
    }
  }
  if (!options.axial_lengths.empty()) {
    truth["axial"] = synthesize_axial(lab);
  }
  // The scene as it was tested, and what is true of it, beside the recordings.
  if (options.tensions.empty()) {
    lab.write_text("scene.toml", model::scene_text(ident::scene_with_accelerometers(
                                     scene, options.rig.accelerometer_mass_kg)));
  }
  lab.write_text("truth.json", truth.dump(2) + "\n");
  context.out << fmt::format("wrote {} files to {} (synthetic, seed {}; truth in truth.json)\n",
                             lab.files.size(), options.out, context.seed);
  return {{"data", "synthetic"}, {"files", lab.files}};
}

describe::Options options_of(SynthesizeOptions& c) {
  return {
      option("scene", c.scene, "Scene file (TOML); its loads are the tests").required(),
      option("--out", c.out, "Folder to write to").required(),
      option("--hits", c.rig.hits, "Hits of every impact").within(1, 1000),
      option("--double-hits", c.rig.double_hits, "Of these, how many are double").within(0, 1000),
      option("--record", c.rig.record_s, "Length of a record", "s").positive(),
      option("--rate", c.rig.sample_rate_hz, "Sample rate", "Hz").positive(),
      option("--finer", c.rig.finer, "Segments of the tested rig over the scene's").within(1, 100),
      option("--tension", c.tensions,
             "Tensions that the cables are set to, N, one row of tests each (default: the scene's)")
          .positive(),
      option("--tension-std", c.tension_std, "Relative error with which a person sets them")
          .within(0.0, 0.5),
      option("--stiffness", c.stiffness,
             "Table of tension_N, EI_Nm2: the cables' EI at each of them")
          .file(),
      choice("--format", c.uff, {"csv", "uff"},
             "Of hammer and release recordings: csv, or uff (58, binary, single precision)"),
      option("--bending-span", c.bending.span_m,
             "Also the bending test of the scene's first cable, span in m")
          .positive(),
      option("--bending-load", c.bending.peak_load_N, "Its largest load", "N").positive(),
      option("--axial-length", c.axial_lengths,
             "Also the hanging-mass test of that cable, lengths in m")
          .positive(),
      option("--axial-length-std", c.axial_length_std, "Error with which they were cut", "m")
          .within(0.0, 0.1),
      option("--axial-mass", c.axial.hung_mass_kg, "Mass hung there", "kg").positive(),
      option("--axial-damping", c.axial.damping_ratio, "Damping ratio of its oscillation")
          .within(0.0, 0.99),
      option("--taps", c.taps, "Taps at every length").within(1, 1000)};
}

}  // namespace

Verb synthesize_verb() {
  return verb_of<SynthesizeOptions>(
      "synthesize", "Virtual laboratory: recordings a rig like this would give, with their truth",
      "Example:\n  rigfit synthesize testdata/jalali2021/scenes/cable.toml --out build/virtual "
      "--seed 7\n      --bending-span 1 --axial-length 0.7 1.0 1.3",
      run);
}

}  // namespace rigfit::apps
