#include "signal/impact/roving_hammer.h"

#include "signal/recording/add_note.h"

namespace rigfit::signal {
namespace {

/// The response at a point.
std::optional<Index> response_at(const StruckPoint& point, const ImpactTest& test) {
  if (point.response || point.name.empty()) return point.response;
  for (std::size_t r = 0; r < test.responses.size(); ++r) {
    const auto channel = static_cast<std::size_t>(test.responses[r]);
    if (point.recordings.front().channels[channel].name == point.name) {
      return static_cast<Index>(r);
    }
  }
  return {};
}

void same_rate(std::span<const StruckPoint> points) {
  const Recording& first = points.front().recordings.front();
  for (const StruckPoint& point : points) {
    const Recording& recording = point.recordings.front();
    const double other = std::abs(recording.sample_rate_hz - first.sample_rate_hz);
    if (other <= 1e-5 * first.sample_rate_hz) continue;  // as of the hits of one point
    throw RecordingError(
        {recording.path.string(), 0, 0, "", fmt::format("{}", recording.sample_rate_hz)},
        fmt::format("is sampled at another rate than {} ({} Hz)", first.path.string(),
                    first.sample_rate_hz),
        "resample it, or analyse the points by themselves: FRFs of several points need one rate");
  }
}

/// The tests' FRFs side by side; the points without FRFs are left out.
FrfSet joined(std::span<const StruckPoint> points, std::vector<ImpactTest>& tests,
              std::vector<std::size_t>& kept, std::vector<Note>& notes) {
  for (std::size_t p = 0; p < tests.size(); ++p) {
    if (tests[p].frfs.H.rows() > 0) {
      kept.push_back(p);
    } else {
      add_note(notes, "point_left_out", points[p].name,
               "Repeat the hits on this point: none can be used, and it is left out");
    }
  }
  FrfSet all = tests[kept.empty() ? 0 : kept.front()].frfs;
  if (kept.empty()) return all;
  all.inputs.clear();
  all.hit_impulse.clear();
  all.notes.clear();
  const auto inputs = static_cast<Index>(kept.size());
  const auto responses = static_cast<Index>(all.responses.size());
  // Columns of the one, by input, among those of all; none where an input has none.
  const auto side_by_side = [&](auto part) {
    auto& matrix = all.*part;
    matrix.setConstant(all.frequency_hz.size(), responses * inputs, 0);
    for (Index i = 0; i < inputs && matrix.size() > 0; ++i) {
      const auto& one = tests[kept[static_cast<std::size_t>(i)]].frfs.*part;
      if (one.rows() < matrix.rows()) {
        matrix.resize(0, 0);
      } else {
        matrix(Eigen::all, Eigen::seqN(i, responses, inputs)) = one;
      }
    }
  };
  side_by_side(&FrfSet::H), side_by_side(&FrfSet::H_std), side_by_side(&FrfSet::coherence);
  std::size_t most = 0;
  Index by_hit_lines = all.H.rows();
  for (const std::size_t p : kept) {
    const auto& hits = tests[p].frfs.by_hit;
    most = std::max(most, hits.size());
    by_hit_lines = std::min(by_hit_lines, hits.empty() ? 0 : hits.front().rows());
  }
  all.by_hit.assign(
      by_hit_lines > 0 ? most : 0,
      MatrixXcd::Constant(by_hit_lines, all.H.cols(), std::numeric_limits<double>::quiet_NaN()));
  int named = 0;
  for (Index i = 0; i < inputs; ++i) {
    const std::size_t p = kept[static_cast<std::size_t>(i)];
    const FrfSet& one = tests[p].frfs;
    MeasuredPoint input = one.inputs.front();
    const auto response = response_at(points[p], tests[p]);
    if (response) {
      input.node = all.responses[static_cast<std::size_t>(*response)].node;
    } else if (!points[p].name.empty()) {
      input.node = static_cast<int>(responses) + ++named;
    }
    if (!points[p].name.empty()) input.name = points[p].name;
    all.inputs.push_back(input);
    all.hit_impulse.push_back(one.hit_impulse.front());
    all.force_noise_span_s = std::max(all.force_noise_span_s, one.force_noise_span_s);
    all.force_noise_std = std::max(all.force_noise_std, one.force_noise_std);
    all.averages = std::min(all.averages, one.averages);
    for (std::size_t h = 0; h < one.by_hit.size() && h < all.by_hit.size(); ++h) {
      all.by_hit[h](Eigen::all, Eigen::seqN(i, responses, inputs)) =
          one.by_hit[h].topRows(by_hit_lines);
    }
    for (const Note& note : one.notes) {
      const bool here = note.where.empty() && points.size() > 1;
      all.notes.push_back({note.code, note.message, here ? input.name : note.where});
    }
  }
  return all;
}

}  // namespace

RovingHammer analyse_roving_hammer(std::span<const StruckPoint> points, const std::string& force,
                                   std::span<const std::string> responses,
                                   const ImpactTestOptions& options) {
  RovingHammer result;
  if (points.empty()) return result;
  same_rate(points);
  ImpactTestOptions chosen = options;
  const auto analyse = [&] {
    result.tests.clear();
    for (const StruckPoint& point : points) {
      result.tests.push_back(analyse_impact_test(point.recordings, force, responses, chosen));
    }
  };
  analyse();
  // One length for all, so that they share their lines.
  Index shortest = std::numeric_limits<Index>::max(), longest = 0;
  for (const ImpactTest& test : result.tests) {
    if (test.frfs.averages == 0) continue;  // it is left out and binds nobody
    shortest = std::min(shortest, test.search.block_samples);
    longest = std::max(longest, test.search.block_samples);
  }
  if (shortest < longest) {
    chosen.hits.block_s =
        static_cast<double>(shortest) / points.front().recordings.front().sample_rate_hz;
    analyse();
    const auto differs = std::ranges::find_if(result.tests, [&](const auto& t) {
      return t.frfs.averages > 0 && t.search.block_samples != shortest;
    });
    if (differs != result.tests.end()) {
      const auto p = static_cast<std::size_t>(differs - result.tests.begin());
      throw RecordingError({points[p].recordings.front().path.string(), 0, 0, force, ""},
                           "a pulse does not fit the blocks that the other points' hits leave",
                           "leave out the recordings with the least time after a hit");
    }
  }
  for (std::size_t p = 0; p < points.size(); ++p) {
    for (const Note& note : result.tests[p].notes) {
      result.notes.push_back(
          {note.code, note.message,
           points.size() == 1 ? note.where
                              : points[p].name + (note.where.empty() ? "" : ": " + note.where)});
    }
  }
  std::vector<std::size_t> kept;
  result.frfs = joined(points, result.tests, kept, result.notes);
  if (kept.empty() || result.frfs.form == FrfForm::unknown) return result;

  double usable = std::numeric_limits<double>::infinity();
  for (const std::size_t p : kept) usable = std::min(usable, result.tests[p].usable_hz);
  const std::pair band = options.hits.band_hz ? *options.hits.band_hz : std::pair(0.0, usable);
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const auto response = response_at(points[kept[i]], result.tests[kept[i]]);
    if (!response) continue;
    const auto input = static_cast<Index>(i);
    result.driving_points.push_back(
        {*response, input, check_driving_point(result.frfs, *response, input, band)});
    const DrivingPoint& driving = result.driving_points.back();
    if (const auto note = note_of(driving.check)) {
      result.notes.push_back({note->code, note->message,
                              result.frfs.responses[static_cast<std::size_t>(*response)].name});
    }
  }
  result.reciprocity = check_reciprocity(result.frfs, band);
  for (const ReciprocityCheck& check : result.reciprocity) {
    // Three times what the error bars expect is beyond chance; under a tenth it is good practice.
    if (check.difference > 0.1 && check.difference > 3 * check.from_noise) {
      add_note(result.notes, "not_reciprocal", check.points[0] + ", " + check.points[1],
               "Check places, directions and sensitivities, and whether the structure is linear: "
               "FRFs both ways differ by {:.2g} % (noise: {:.2g} %)",
               100 * check.difference, 100 * check.from_noise);
    }
  }
  return result;
}

}  // namespace rigfit::signal
