// rigfit synthesize: a virtual laboratory. What it writes is synthetic and says so in every file.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <memory>

#include "apps/json_document.h"
#include "apps/output_file.h"
#include "apps/progress.h"
#include "apps/verbs/all.h"
#include "ident/virtual_axial.h"
#include "ident/virtual_bending.h"
#include "ident/virtual_rig.h"
#include "model/modal_analysis.h"
#include "model/read_scene.h"
#include "model/response.h"
#include "model/scene_error.h"
#include "signal/write_csv.h"

namespace rigfit::apps {
namespace {
namespace fs = std::filesystem;

struct SynthesizeOptions {
  std::string scene;
  std::string out;
  ident::VirtualRigOptions rig;
  double bending_span = 0;
  double bending_peak_load = 10;
  std::vector<double> axial_lengths;
  double axial_mass = 2.2;
  double axial_damping_ratio = 0.017;
  int taps = 5;
};

using Header = std::vector<std::pair<std::string, std::string>>;

class Writer {
 public:
  Writer(const SynthesizeOptions& options, const model::Scene& scene, VerbContext& context)
      : options_(options), scene_(scene), context_(context) {}

  void write(const std::string& name, const std::string& test, const signal::Recording& recording) {
    const fs::path path = fs::path(options_.out) / name;
    make_output_folder(path.parent_path());
    const Header header{{"Data", "synthetic (virtual laboratory)"},
                        {"Test", test},
                        {"Scene", scene_.title},
                        {"Seed", std::to_string(context_.seed)},
                        {"Sampling Rate(Hz)", fmt::format("{:g}", recording.sample_rate_hz)}};
    write_whole_file(path, csv_text(recording, header));
    files_.push_back(path.string());
  }

  void write_text(const std::string& name, const std::string& text) {
    const fs::path path = fs::path(options_.out) / name;
    write_whole_file(path, text);
    files_.push_back(path.string());
  }

  [[nodiscard]] const std::vector<std::string>& files() const { return files_; }

 private:
  const SynthesizeOptions& options_;
  const model::Scene& scene_;
  VerbContext& context_;
  std::vector<std::string> files_;
};

const model::Member& cable_of(const model::Scene& scene, const std::string& file) {
  for (const auto& member : scene.members) {
    if (member.kind == model::Member::Kind::cable) return member;
  }
  throw model::SceneError({file, 0, 0, "member"}, "has no cable to bend or to hang a mass on",
                          "leave out --bending-span and --axial-length");
}

Json truth_of_rig(const model::Scene& scene, const ident::VirtualRigOptions& options) {
  const model::Scene fine = ident::finer_scene(scene, options.finer);
  model::ModesOptions modes;
  modes.count = 12;
  modes.shapes = false;
  const auto analysis = model::analyse_modes(fine, modes);
  if (analysis.equilibrium.status != model::EquilibriumStatus::converged) {
    throw NotConverged("no equilibrium to test: " + analysis.equilibrium.reason);
  }
  Json list = Json::array();
  for (const auto& mode : analysis.modes) {
    list.push_back({{"frequency_hz", mode.frequency_hz},
                    {"damping_ratio", mode.damping_ratio},
                    {"plane", model::name_of(mode.plane)},
                    {"family", model::name_of(mode.family)}});
  }
  Json parameters;
  for (const auto& name : model::parameter_names(scene)) {
    parameters[name] = model::parameter(scene, name);
  }
  return {{"parameters", std::move(parameters)},
          {"segments_times", options.finer},
          {"modes", std::move(list)}};
}

Json synthesize_rig(const SynthesizeOptions& options, const model::Scene& scene,
                    VerbContext& context, Writer& writer) {
  long total = 0;
  for (const auto& load : scene.loads) {
    total += load.kind == model::Load::Kind::impact ? options.rig.hits : 1;
  }
  Progress progress("Virtual rig", total, context.quiet);
  const ident::Simulate simulate = [&](const model::Scene& tested, double duration, double rate) {
    model::ResponseOptions response;
    response.sampling.duration_s = duration;
    response.sampling.rate_hz = rate;
    auto result = model::simulate_response(tested, response);
    if (!result.completed) throw NotConverged("virtual rig: " + result.reason);
    return std::move(result.samples);
  };
  const auto records = ident::virtual_rig_records(scene, options.rig, simulate, context.seed,
                                                  [&] { progress.advance(); });
  Json list = Json::array();
  for (const auto& record : records) {
    const std::string name = record.hit > 0
                                 ? fmt::format("rig/{}-hit{}.csv", record.load, record.hit)
                                 : fmt::format("rig/{}.csv", record.load);
    writer.write(name, record.hit > 0 ? "hammer" : "release", record.recording);
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

Json synthesize_bending(const SynthesizeOptions& options, const model::Member& cable,
                        VerbContext& context, Writer& writer) {
  ident::VirtualBendingTest test;
  test.EI_Nm2 = cable.EI[0];
  test.span_m = options.bending_span;
  test.tension_N = cable.tension.value_or(0);
  test.peak_load_N = options.bending_peak_load;
  test.tension_cell = options.rig.instruments.tension_cell;
  test.load_cell = options.rig.instruments.load_cell;
  test.lvdt = options.rig.instruments.lvdt;
  ident::Random random = ident::random_stream(context.seed, 2'000'000);
  const std::string name = fmt::format("bending/T{:g}N.csv", test.tension_N);
  writer.write(name, fmt::format("bending, span {:g} m", test.span_m),
               ident::virtual_bending_record(test, random));
  return {{"file", name},
          {"EI_Nm2", test.EI_Nm2},
          {"span_m", test.span_m},
          {"tension_N", test.tension_N},
          {"friction_load_N", test.friction_load_N}};
}

Json synthesize_axial(const SynthesizeOptions& options, const model::Member& cable,
                      VerbContext& context, Writer& writer) {
  Json list = Json::array();
  for (std::size_t i = 0; i < options.axial_lengths.size(); ++i) {
    ident::VirtualAxialTest test;
    test.EA_N = cable.EA;
    test.mass_per_length_kg_m = cable.mass_per_length;
    test.length_m = options.axial_lengths[i];
    test.hung_mass_kg = options.axial_mass;
    test.damping_ratio = options.axial_damping_ratio;
    test.load_cell = options.rig.instruments.tension_cell;
    const auto truth = ident::axial_truth(test);
    for (int tap = 1; tap <= options.taps; ++tap) {
      ident::Random random =
          ident::random_stream(context.seed, 3'000'000 + 1000 * i + static_cast<unsigned>(tap));
      const std::string name = fmt::format("axial/L{:g}m-{}.csv", test.length_m, tap);
      writer.write(
          name, fmt::format("axial, length {:g} m, mass {:g} kg", test.length_m, test.hung_mass_kg),
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

Json run(const SynthesizeOptions& options, VerbContext& context) {
  context.input(options.scene);
  const model::Scene scene = model::read_scene(options.scene);
  const bool rig = !scene.loads.empty() && !scene.sensors.empty();
  if (!rig && options.bending_span <= 0 && options.axial_lengths.empty()) {
    throw UsageError(options.scene +
                     ": nothing to test: give the scene a load and a sensor, or ask for "
                     "--bending-span or --axial-length");
  }
  make_output_folder(options.out);
  Writer writer(options, scene, context);
  Json truth;
  truth["data"] = "synthetic";
  truth["scene"] = scene.title;
  truth["seed"] = context.seed;
  if (rig) {
    truth["rig"] = truth_of_rig(scene, options.rig);
    truth["rig"]["records"] = synthesize_rig(options, scene, context, writer);
  }
  if (options.bending_span > 0) {
    truth["bending"] = synthesize_bending(options, cable_of(scene, options.scene), context, writer);
  }
  if (!options.axial_lengths.empty()) {
    truth["axial"] = synthesize_axial(options, cable_of(scene, options.scene), context, writer);
  }
  // The scene as it was tested, and what is true of it, beside the recordings.
  writer.write_text("scene.toml", model::scene_text(scene));
  writer.write_text("truth.json", truth.dump(2) + "\n");
  context.out << fmt::format("wrote {} files to {} (synthetic, seed {}; truth in truth.json)\n",
                             writer.files().size(), options.out, context.seed);
  Json result;
  result["data"] = "synthetic";
  result["files"] = writer.files();
  return result;
}

}  // namespace

void add_synthesize(CLI::App& program, Verbs& verbs) {
  auto options = std::make_shared<SynthesizeOptions>();
  CLI::App* app = program.add_subcommand(
      "synthesize", "Virtual laboratory: recordings a rig like this would give, with their truth");
  app->add_option("scene", options->scene, "Scene file (TOML); its loads are the tests")
      ->required()
      ->type_name("SCENE");
  app->add_option("--out", options->out, "Folder to write to")->required()->type_name("DIR");
  app->add_option("--hits", options->rig.hits, "Hits of every impact")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app->add_option("--double-hits", options->rig.double_hits, "Of these, how many are double")
      ->check(CLI::Range(0, 1000))
      ->capture_default_str();
  app->add_option("--record", options->rig.record_s, "Length of a record, s")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app->add_option("--rate", options->rig.sample_rate_hz, "Sample rate, Hz")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app->add_option("--finer", options->rig.finer, "Segments of the tested rig over the scene's")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  app->add_option("--bending-span", options->bending_span,
                  "Also the bending test of the scene's first cable, span in m")
      ->check(CLI::PositiveNumber);
  app->add_option("--bending-load", options->bending_peak_load, "Its largest load, N")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app->add_option("--axial-length", options->axial_lengths,
                  "Also the hanging-mass test of that cable, lengths in m")
      ->check(CLI::PositiveNumber);
  app->add_option("--axial-mass", options->axial_mass, "Mass hung there, kg")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app->add_option("--axial-damping", options->axial_damping_ratio,
                  "Damping ratio of its oscillation")
      ->check(CLI::Range(0.0, 0.99))
      ->capture_default_str();
  app->add_option("--taps", options->taps, "Taps at every length")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app->footer(
      "Example:\n  rigfit synthesize testdata/jalali2021/scenes/cable.toml --out build/virtual "
      "--seed 7\n      --bending-span 1 --axial-length 0.7 1.0 1.3");
  verbs.push_back({app, [options](VerbContext& context) { return run(*options, context); }});
}

}  // namespace rigfit::apps
