#include "signal/writers/writers.h"

#include "tests/test.h"

namespace rigfit::signal::writers_test {

TEST(WriteCsv, WritesHeaderUnitsMissingAndQuotes) {
  Recording recording{.sample_rate_hz = 500};
  Channel a;
  a.name = "acc, mid";
  a.source_unit = "g";
  a.si_per_source = 9.80665;
  a.samples = Eigen::Vector2d(9.80665, NAN);
  recording.channels = {a};
  EXPECT_EQ(csv_text(recording, {{"Data", "synthetic"}}),
            "Data,synthetic\nTime (s),\"acc, mid (g)\"\n0,1\n0.002,\n");
}

}  // namespace rigfit::signal::writers_test
