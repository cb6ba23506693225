// rigfit synthesize: a virtual laboratory. What it writes is synthetic and says so in every file.

#include <random>

#include "apps/campaign_file/bending_files.h"
#include "apps/cli/progress.h"
#include "apps/cli/verbs/all.h"
#include "ident/virtual_rig/virtual_bench.h"
#include "ident/virtual_rig/virtual_rig.h"
#include "model/linear/modal_analysis.h"
#include "model/response/response.h"
#include "model/scene/read_scene.h"
#include "signal/writers/writers.h"

namespace rigfit::apps {
namespace {

namespace fs = std::filesystem;

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

/// The rig as it was set up for one row of tests.
struct State {
  model::Scene scene;
  std::uint64_t stream = 0;  ///< added to the seed
  std::optional<double> meant_N;
};

/// Makes the recordings, writes them and says what is true of them.
struct Laboratory {
  const SynthesizeOptions& options;
  const model::Scene& scene;
  VerbContext& context;
  std::vector<std::string> files = {};

  [[nodiscard]] const model::Member& cable_of(const model::Scene& rig) const {
    const auto cable =
        std::ranges::find(rig.members, model::Member::Kind::cable, &model::Member::kind);
    if (cable != rig.members.end()) return *cable;
    throw model::SceneError({options.scene, 0, 0, "member"},
                            "has no cable to tension, to bend or to hang a mass on",
                            "leave out --tension, --bending-span and --axial-length");
  }
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
    write_text(
        name,
        uff ? uff_text(recording, fmt::format("{}, {}, seed {}", data, scene.title, context.seed))
            : csv_text(recording,
                       {{"Data", data},
                        {"Test", test},
                        {"Scene", scene.title},
                        {"Seed", std::to_string(context.seed)},
                        {"Sampling Rate(Hz)", fmt::format("{:g}", recording.sample_rate_hz)}}));
    return name;
  }

  std::vector<State> states() {
    if (options.tensions.empty()) return {{scene, 0, std::nullopt}};
    (void)cable_of(scene);
    ident::StiffnessCurve stiffness;
    if (!options.stiffness.empty()) stiffness = read_stiffness_curve(options.stiffness, context);
    std::vector<State> states;
    for (const double tension : options.tensions) {
      State state{cables_at(scene, tension, stiffness, options.stiffness, context),
                  10'000'019 * states.size(), tension};
      ident::Random random = ident::random_stream(context.seed + state.stream, 4'000'000);
      // Cables that meet pull alike: one error for all of them.
      const double error = options.tension_std * std::normal_distribution<double>()(random);
      for (const auto& name : use_of_cables(scene).tension_of) {
        model::set_parameter(state.scene, name, tension * (1 + error));
      }
      states.push_back(std::move(state));
    }
    return states;
  }

  /// Parameters and modes of the rig that is tested, finer than its scene.
  [[nodiscard]] Json truth_of(const State& state) const {
    const auto& rig = options.rig;
    model::ModesOptions modes;
    modes.count = 12;
    modes.shapes = false;
    const auto analysis = model::analyse_modes(
        ident::finer_scene(ident::scene_with_accelerometers(state.scene, rig.accelerometer_mass_kg),
                           rig.finer),
        modes);
    if (analysis.equilibrium.status != model::EquilibriumStatus::converged) {
      throw NotConverged("no equilibrium to test: " + analysis.equilibrium.reason);
    }
    Json parameters;
    for (const auto& name : model::parameter_names(state.scene)) {
      parameters[name] = model::parameter(state.scene, name);
    }
    return {{"parameters", std::move(parameters)},
            {"segments_times", rig.finer},
            {"accelerometer_mass_kg", rig.accelerometer_mass_kg},
            {"modes", describe::json_of(analysis.modes)}};
  }

  Json rig(const State& state, Progress& progress) {
    const ident::Simulate simulate = [&](const model::Scene& tested, double duration, double rate) {
      model::ResponseOptions response;
      response.sampling.duration_s = duration;
      response.sampling.rate_hz = rate;
      auto result = model::simulate_response(tested, response);
      if (!result.completed) throw NotConverged("virtual rig: " + result.reason);
      return std::move(result.samples);
    };
    const auto write_record = [&](const ident::VirtualRigRecord& record) {
      const bool hit = record.hit > 0;
      std::string name = "rig/" + (state.meant_N ? fmt::format("T{:g}N-", *state.meant_N) : "");
      name += record.load + (hit ? fmt::format("-hit{}", record.hit) : "");
      Json entry{{"file", write(name, hit ? "hammer" : "release", record.recording, options.uff)},
                 {"load", record.load}};
      const bool twice = record.second_after_s > 0;
      if (hit) entry.update({{"peak_N", record.peak_N}, {"double_hit", twice}});
      if (twice) {
        entry["second_peak_N"] = record.second_peak_N;
        entry["second_after_s"] = record.second_after_s;
      }
      return entry;
    };
    Json truth = truth_of(state);
    if (state.meant_N) truth["tension_meant_N"] = *state.meant_N;
    truth["records"] = describe::json_list(
        ident::virtual_rig_records(state.scene, options.rig, simulate, context.seed + state.stream,
                                   [&] { progress.advance(); }),
        write_record);
    return truth;
  }

  Json bending(const State& state) {
    const auto& cable = cable_of(state.scene);
    const auto& instruments = options.rig.instruments;
    ident::VirtualBendingTest test = options.bending;
    test.EI_Nm2 = cable.EI[0];
    test.tension_N = cable.tension.value_or(0);
    test.tension_cell = instruments.tension_cell;
    test.load_cell = instruments.load_cell;
    test.lvdt = instruments.lvdt;
    ident::Random random = ident::random_stream(context.seed + state.stream, 2'000'000);
    return {{"file", write(fmt::format("bending/T{:g}N", state.meant_N.value_or(test.tension_N)),
                           fmt::format("bending, span {:g} m", test.span_m),
                           ident::virtual_bending_record(test, random))},
            {"EI_Nm2", test.EI_Nm2},
            {"span_m", test.span_m},
            {"tension_N", test.tension_N},
            {"friction_load_N", test.friction_load_N},
            {"friction_travel_m", test.friction_travel_m}};
  }

  Json axial() {
    const auto& cable = cable_of(scene);
    ident::VirtualAxialTest test = options.axial;
    test.EA_N = cable.EA;
    test.mass_per_length_kg_m = cable.mass_per_length;
    test.load_cell = options.rig.instruments.tension_cell;
    Json list = Json::array();
    for (std::size_t i = 0; i < options.axial_lengths.size(); ++i) {
      const double meant_m = options.axial_lengths[i];
      ident::Random cut = ident::random_stream(context.seed, 2'900'000 + i);
      test.length_m = meant_m + options.axial_length_std * std::normal_distribution<double>()(cut);
      for (int tap = 1; tap <= options.taps; ++tap) {
        ident::Random random =
            ident::random_stream(context.seed, 3'000'000 + 1000 * i + static_cast<unsigned>(tap));
        list.push_back({{"file", write(fmt::format("axial/L{:g}m-{}", meant_m, tap),
                                       fmt::format("axial, length {:g} m, mass {:g} kg", meant_m,
                                                   test.hung_mass_kg),
                                       ident::virtual_axial_record(test, random))},
                        {"length_m", test.length_m},
                        {"mass_kg", test.hung_mass_kg},
                        {"EA_N", test.EA_N},
                        {"frequency_hz", ident::axial_frequency_hz(test)},
                        {"damping_ratio", test.damping_ratio}});
      }
    }
    return list;
  }
};

Json run(SynthesizeOptions& options, VerbContext& context) {
  constexpr double kMostSamples = 5e6;  // per record: some minutes of simulation
  const model::Scene scene = scene_of(options.scene, context);
  const bool rig = !scene.loads.empty() && !scene.sensors.empty();
  if (!rig && options.bending.span_m <= 0 && options.axial_lengths.empty()) {
    throw UsageError(options.scene +
                     ": nothing to test: give the scene a load and a sensor, or ask for "
                     "--bending-span or --axial-length");
  }
  if (!(options.rig.record_s * options.rig.sample_rate_hz <= kMostSamples)) {
    throw UsageError("more than 5 million samples a record: lower --rate or --record");
  }
  Laboratory lab{options, scene, context};
  const auto states = lab.states();
  make_output_folder(options.out);
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
    truth["rig"] = describe::json_list(states, [&](auto& one) { return lab.rig(one, progress); });
  }
  if (options.bending.span_m > 0) {
    truth["bending"] = describe::json_list(states, [&](auto& one) { return lab.bending(one); });
  }
  if (!options.axial_lengths.empty()) truth["axial"] = lab.axial();
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
          .file()
          .needs("--tension"),
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
      run, false, false, []() -> Json {
        return describe::schema_of_keys(
            {{"data", describe::schema_of<std::string>()},
             {"files", describe::schema_of<std::vector<std::string>>()}});
      });
}

}  // namespace rigfit::apps
