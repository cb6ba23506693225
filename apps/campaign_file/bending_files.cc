#include "apps/campaign_file/bending_files.h"

#include "apps/campaign_file/recordings.h"
#include "apps/results/results_json.h"
#include "model/scene/scene.h"
#include "signal/numerics/numbers.h"
#include "signal/readers/csv_fields.h"
#include "signal/recording/recording.h"
#include "signal/recording/recording_time.h"

namespace rigfit::apps {
namespace {

using signal::kNaN;

/// The column a person means: by the name given, else by one of the usual beginnings.
const signal::Channel* find(const signal::Recording& recording, const std::string& asked,
                            const std::vector<std::string>& beginnings) {
  if (!asked.empty()) {
    try {
      return &recording.channel(asked);
    } catch (const signal::RecordingError&) {
      return nullptr;
    }
  }
  return channel_like(recording, beginnings);
}

/// Correlation of two channels without missing samples; 0: something is missing or constant.
double correlation(const Eigen::VectorXd& x, const Eigen::VectorXd& y) {
  const Eigen::ArrayXd a = x.array() - x.mean(), b = y.array() - y.mean();
  const double r = (a * b).sum() / std::sqrt(a.square().sum() * b.square().sum());
  return std::isfinite(r) ? std::abs(r) : 0;
}

/// Standard deviation over mean.
double relative_change(const Eigen::VectorXd& x) {
  const double mean = std::abs(x.mean());
  return mean > 0 ? std::sqrt((x.array() - x.mean()).square().mean()) / mean : 1e300;
}

const std::vector<std::string> kLoadNames = {"load", "force",  "standard force",
                                             "q",    "weight", "mass"};
const std::vector<std::string> kDeflectionNames = {"deflection", "displacement", "lvdt",
                                                   "extension",  "crosshead",    "d"};

/// Finds the columns of a table or record that a person means.
class Columns {
 public:
  Columns(const signal::Recording& recording, const BendingColumns& names,
          std::vector<Finding>& warnings)
      : recording_(recording), names_(names), warnings_(warnings), file_(recording.path.string()) {
    if (names_.tension == "0") names_.tension.clear();
    const auto table = load_deflection(recording);
    for (const auto what :
         {&LoadDeflection::tension, &LoadDeflection::load, &LoadDeflection::deflection}) {
      if (table && (names_.*what).empty()) names_.*what = (*table).*what;
    }
  }

  [[nodiscard]] ident::BendingSource source() const {
    ident::BendingSource source;
    source.name = file_;
    if (const auto* EI = find(recording_, "", {"ei"})) {
      source.values = values(*EI);
      return source;
    }
    auto& record = source.record;
    if (!names_.without_tension) {
      record.tension_N = column("tension", names_.tension, {"tension", "preload"}, "N").samples;
    }
    record.load_N = load();
    if (names_.without_tension) record.tension_N.setZero(record.load_N.size());
    record.deflection_m = column("deflection", names_.deflection, kDeflectionNames, "m").samples;
    return source;
  }

 private:
  /// In newtons; masses as dead weights.
  [[nodiscard]] Eigen::VectorXd load() const {
    const auto* found = find(recording_, names_.load, kLoadNames);
    const bool named = found != nullptr && signal::lower_case(found->name).starts_with("mass");
    // "g" is the standard gravity to the reader, grams on a mass or load.
    const bool grams = found != nullptr && found->source_unit == "g";
    if (found == nullptr || !(named || grams || found->unit == "kg")) {
      return column("load", names_.load, kLoadNames, "N").samples;
    }
    if (!grams && found->unit != "kg") {
      throw wrong(found->name, found->source_unit, "is a mass without a unit of mass",
                  "title it in kg or g, or in a TOML file beside it");
    }
    warnings_.push_back({"assumed",
                         "masses are taken as dead weights, times 9.80665 m/s2; the place on earth "
                         "changes that by up to 0.3 %",
                         file_ + ": " + found->name});
    return found->samples * (grams ? 1e-3 : 9.80665);
  }

  [[nodiscard]] const signal::Channel& column(const std::string& what, const std::string& asked,
                                              const std::vector<std::string>& beginnings,
                                              const std::string& si) const {
    const auto* found = find(recording_, asked, beginnings);
    const std::string remedy = fmt::format(fmt::runtime(names_.remedy), what);
    if (found == nullptr) {
      const bool none = what == "tension" && asked.empty();
      throw wrong(asked.empty() ? what : asked, "", "no such column",
                  fmt::format("{}{}; there are: {}", remedy,
                              none ? ", or say that there is none (--tension 0)" : "",
                              signal::listed_names(recording_.channels)));
    }
    if (found->unit.empty()) {
      warnings_.push_back(
          {"no_unit", fmt::format("no unit given, taken as {}", si), file_ + ": " + found->name});
    } else if (found->unit != si) {
      throw wrong(found->name, found->unit,
                  fmt::format("its unit is not one of {}", si == "N" ? "force" : "length"),
                  remedy + ", or give its unit in a TOML file beside the recording");
    }
    return *found;
  }

  [[nodiscard]] std::vector<ident::StiffnessPoint> values(const signal::Channel& EI) const {
    const auto& tension = column("tension", names_.tension, {"tension"}, "N");
    const auto* std = find(recording_, "", {"std", "uncertainty"});
    const auto* low = find(recording_, "", {"low"});
    const auto* high = find(recording_, "", {"high"});
    std::vector<ident::StiffnessPoint> points;
    for (Eigen::Index i = 0; i < EI.samples.size(); ++i) {
      const auto at = [&](const signal::Channel* one) {
        return one == nullptr ? kNaN : one->samples[i];
      };
      const ident::StiffnessPoint point{at(&tension), at(&EI), at(std), at(low), at(high)};
      const bool bad_EI = point.tension_N > 0;
      if (bad_EI && point.EI_Nm2 > 0) {
        points.push_back(point);
      } else if (std::isnan(point.EI_Nm2) && !std::isinf(point.tension_N)) {
        warnings_.push_back(
            {"missing", fmt::format("row {} holds no EI and is left out", i + 1), file_});
      } else {
        throw wrong(bad_EI ? EI.name : tension.name,
                    fmt::format("{}", bad_EI ? point.EI_Nm2 : point.tension_N),
                    fmt::format("row {} has no positive number", i + 1), "mend or remove the row");
      }
    }
    if (points.empty()) {
      throw wrong(EI.name, "", "holds no number", "give at least one row of tension and EI");
    }
    return points;
  }

  [[nodiscard]] signal::RecordingError wrong(const std::string& channel, const std::string& value,
                                             const std::string& problem,
                                             const std::string& remedy) const {
    return {{.file = file_, .channel = channel, .value = value}, problem, remedy};
  }

  const signal::Recording& recording_;
  BendingColumns names_;  ///< what a person gives, else how the table shows what it is
  std::vector<Finding>& warnings_;
  std::string file_;
};

/// The tests of a bending result that gave an EI, fitted again by the same laws.
ident::StiffnessCurve curve_of_result(const std::filesystem::path& path) {
  const Json document = read_document(path, "tests", "rigfit bending ... --json FILE (or a table)");
  const auto or_zero = [](double x) { return std::isfinite(x) ? x : 0; };
  std::vector<ident::StiffnessPoint> points;
  for (const auto& test : document["tests"]) {
    const Json EI = test.is_object() ? test.value("EI_Nm2", Json()) : Json();
    ident::StiffnessPoint point{
        number_in(test, "tension_N"), number_in(EI, "value"),
        number_in(EI, "std"),         number_in(EI, "low"),
        number_in(EI, "high"),        or_zero(number_in(test, "shared_relative_std"))};
    point.tension_std_N = or_zero(number_in(test, "tension_spread_N"));
    if (point.tension_N > 0 && point.EI_Nm2 > 0) points.push_back(point);
  }
  ident::StiffnessLawOptions options;
  options.assumed_relative_std = or_zero(number_in(document, "assumed_relative_std"));
  const Json bounds = document.value("bounds", Json());
  const double least = number_in(bounds, "EI_min_Nm2"), most = number_in(bounds, "EI_max_Nm2");
  if (least > 0 && most > least) options.bounds = ident::StiffnessBounds{least, most};
  return ident::StiffnessCurve(std::move(points), options);
}

}  // namespace

const signal::Channel* channel_like(const signal::Recording& recording,
                                    const std::vector<std::string>& beginnings) {
  for (const auto& beginning : beginnings) {
    for (const auto& channel : recording.channels) {
      if (signal::lower_case(channel.name).starts_with(beginning)) return &channel;
    }
  }
  return nullptr;
}

std::optional<LoadDeflection> load_deflection(const signal::Recording& recording) {
  LoadDeflection found;
  std::vector<const signal::Channel*> forces;
  const signal::Channel* way = find(recording, "", {"deflection", "displacement", "lvdt"});
  for (const auto& channel : recording.channels) {
    const bool grams = channel.source_unit == "g" && find(recording, "", {"load"}) == &channel;
    if (channel.quantity == signal::Quantity::force || channel.unit == "kg" || grams ||
        signal::lower_case(channel.name).starts_with("mass")) {
      forces.push_back(&channel);
    } else if (channel.quantity == signal::Quantity::displacement && way == nullptr) {
      way = &channel;
    } else if (channel.quantity == signal::Quantity::displacement && way != &channel) {
      return std::nullopt;
    }
  }
  const auto* const named_tension = find(recording, "", {"tension", "preload"});
  const auto* const named_load = find(recording, "", {"load", "force", "q"});
  if (named_tension != nullptr && named_load != nullptr && way != nullptr) {
    return LoadDeflection{named_tension->name, named_load->name, way->name};
  }
  if (way == nullptr || forces.empty() || forces.size() > 2 || !way->samples.allFinite()) return {};
  const auto& d = way->samples;
  int crossings = 0;
  const double middle = d.mean();
  for (Eigen::Index i = 1; i < d.size(); ++i) crossings += (d[i - 1] < middle) != (d[i] < middle);
  constexpr int kMostTurns = 20;  // a bending test has fewer; a vibration has more
  if (crossings >= kMostTurns || d.size() < 3) return std::nullopt;
  for (const auto* force : forces) {
    if (!force->samples.allFinite()) return std::nullopt;
  }
  const signal::Channel *load = forces.front(), *tension = nullptr;
  if (forces.size() == 2) {
    tension = forces.back();
    const double r_load = correlation(load->samples, d), r_other = correlation(tension->samples, d);
    const double c_load = relative_change(load->samples),
                 c_other = relative_change(tension->samples);
    const bool steady = std::min(c_load, c_other) < 0.2 * std::max(c_load, c_other);
    if (steady ? c_load < c_other : r_load < r_other) std::swap(load, tension);
    if (!steady && std::min(r_load, r_other) > 0.7 * std::max(r_load, r_other)) return std::nullopt;
  }
  if (correlation(load->samples, d) < 0.8) return std::nullopt;
  return LoadDeflection{tension == nullptr ? "" : tension->name, load->name, way->name};
}

void drop_time_notes(signal::Recording& recording) {
  std::erase_if(recording.notes, [](const signal::Note& note) {
    return note.code == "no_sample_rate" || note.code.starts_with("time_");
  });
}

signal::Recording load_bending_file(const std::filesystem::path& path, VerbContext& context) {
  signal::Recording recording = load_untold(path, context);
  drop_time_notes(recording);
  // Missing units are said of the columns that are used.
  std::erase_if(recording.notes, [](const auto& note) { return note.code == "no_unit"; });
  tell_notes(recording, context);
  return recording;
}

ident::BendingSource bending_source(const signal::Recording& recording,
                                    const BendingColumns& columns, std::vector<Finding>& warnings) {
  return Columns(recording, columns, warnings).source();
}

ident::StiffnessCurve read_stiffness_curve(const std::filesystem::path& path,
                                           VerbContext& context) {
  context.input(path.string());
  if (path.extension() == ".json") return curve_of_result(path);
  std::vector<Finding> findings;
  const auto source = bending_source(load_bending_file(path, context), {}, findings);
  context.tell(findings);
  if (source.values.empty()) {
    throw signal::RecordingError({.file = path.string(), .channel = "EI_Nm2", .value = ""},
                                 "no such column",
                                 "give a table with columns tension_N and EI_Nm2");
  }
  return ident::StiffnessCurve(source.values);
}

ident::SceneUse use_of_cables(const model::Scene& scene) {
  ident::SceneUse use;
  use.scene = scene;
  for (const auto& member : scene.members) {
    if (member.kind != model::Member::Kind::cable) continue;
    use.tension_of.push_back(member.name + ".tension");
    use.EI_of.push_back(member.name + ".EI");
    use.EA_of.push_back(member.name + ".EA");
  }
  return use;
}

model::Scene cables_at(const model::Scene& scene, double tension,
                       const ident::StiffnessCurve& curve, const std::string& file,
                       VerbContext& context) {
  const auto at = curve.empty() ? ident::StiffnessAtTension() : curve.at(tension);
  if (at.extrapolated) {
    context.warn(
        "extrapolated",
        fmt::format("EI at {:.4g} N lies outside the tested tensions ({:.4g} to {:.4g} N): "
                    "{:.4g} N m2 by {}",
                    tension, curve.lowest_tension_N(), curve.highest_tension_N(), at.EI_Nm2,
                    curve.source() == ident::StiffnessSource::interpolation
                        ? "the nearest test"
                        : ident::name_of(curve.source())),
        file);
  }
  return ident::scene_at(use_of_cables(scene), {curve, {}, {}}, tension);
}

}  // namespace rigfit::apps
