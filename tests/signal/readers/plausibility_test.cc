// Sensitivities and units off by a thousand are said, ordinary measurements are not.
#include "signal/readers/recording_description.h"

#include "tests/test.h"

namespace rigfit::signal::plausibility_test {

/// A channel of a file in volts with a peak of `volts`.
Recording in_volts(double volts) {
  return {.path = "hits.csv",
          .channels = {{.name = "hammer",
                        .unit = "V",
                        .source_unit = "V",
                        .quantity = Quantity::voltage,
                        .samples = VectorXd::LinSpaced(11, 0, volts)}}};
}

RecordingDescription sensitivity(double value, const std::string& unit) {
  return {.channels = {{.source = "hammer", .sensitivity = value, .sensitivity_unit = unit}}};
}

std::string suspected(const Recording& recording) {
  for (const auto& note : recording.notes) {
    if (note.code == "unit_suspected") return note.message;
  }
  return "";
}

TEST(Plausibility, SensitivitiesAThousandTimesOff) {
  struct Case {
    double volts, value;
    const char *unit, *said;  // empty: nothing
  };
  // A hit of 440 N by 2.27 mV/N gives 1 V; 5 g by 100 mV/g give 0.5 V.
  for (const Case& c : {Case{1, 2.27, "mV/N", ""}, Case{1000, 2.27, "mV/N", "more than"},
                        Case{1e-3, 2.27, "V/N", "less than"}, Case{0.5, 100, "mV/g", ""},
                        Case{0.5, 100e-3, "mV/g", ""}, Case{500, 10, "mV/g", "5e+04 g"},
                        Case{5, 2e-3, "mV/g", "2.5e+06 g"}}) {
    Recording recording = in_volts(c.volts);
    apply_description(sensitivity(c.value, c.unit), recording);
    if (std::string(c.said).empty()) {
      EXPECT_EQ(suspected(recording), "") << c.volts << ' ' << c.value << ' ' << c.unit;
    } else {
      EXPECT_THAT(suspected(recording), HasSubstr(c.said)) << c.volts << ' ' << c.unit;
    }
    // A later description that says nothing of the channel keeps it, one that mends it takes it
    // off.
    apply_description({}, recording);
    EXPECT_EQ(suspected(recording).empty(), std::string(c.said).empty());
  }
  Recording mended = in_volts(1000);
  apply_description(sensitivity(2.27, "mV/N"), mended);
  apply_description(sensitivity(2.27, "V/N"), mended);
  EXPECT_EQ(suspected(mended), "");
}

TEST(Plausibility, ValuesAsTheFileGivesThem) {
  const auto said = [](Quantity quantity, double value) {
    Recording recording = in_volts(0);
    recording.channels[0].quantity = quantity;
    recording.channels[0].unit = quantity == Quantity::force ? "N" : "m/s^2";
    recording.channels[0].source_unit = recording.channels[0].unit;
    recording.channels[0].samples.setConstant(value);
    apply_description({}, recording);
    return suspected(recording);
  };
  EXPECT_THAT(said(Quantity::acceleration, 1e5 * 9.80665), HasSubstr("1e+05 g"));
  EXPECT_EQ(said(Quantity::acceleration, 20), "");
  EXPECT_EQ(said(Quantity::acceleration, 0), "");
  EXPECT_EQ(said(Quantity::force, 5e6), "");  // in a stay cable
}

TEST(Descriptions, NamesAreThoseOfTheFileAndOnesOwn) {
  const auto described = [](std::vector<ChannelDescription> channels) {
    Recording recording = in_volts(1);
    recording.channels.push_back(in_volts(2).channels[0]);
    recording.channels[1].name = "a";
    apply_description({.channels = std::move(channels)}, recording);
    return recording.channel("a").samples.maxCoeff();
  };
  EXPECT_EQ(described({{.source = "hammer", .name = "a"}, {.source = "a", .name = "hammer"}}), 1);
  EXPECT_THROW(described({{.source = "hammer", .name = "a"}}), RecordingError);
  EXPECT_THROW(described({{.source = "a", .name = "b"}, {.source = "#2"}}), RecordingError);
}

}  // namespace rigfit::signal::plausibility_test
