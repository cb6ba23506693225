// kind = "tension" of a campaign's tests. Keys: campaign.h.
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "apps/campaign_file/campaign_tests.h"
#include "apps/campaign_file/measured_modes.h"

namespace rigfit::apps {
namespace {

using model::Bound;
using model::TomlTable;

/// `key` with `key`_std, 0 where there is none.
signal::Estimate with_std(TomlTable& table, const std::string& key, double value,
                          const std::string& unit) {
  return {value, table.number_or(key + "_std", Bound::not_negative, unit, 0)};
}

std::optional<signal::Estimate> optional_with_std(TomlTable& table, const std::string& key,
                                                  const std::string& unit) {
  const auto value = table.optional_number(key, Bound::positive, unit);
  if (!value) return std::nullopt;
  return with_std(table, key, *value, unit);
}

void read_cable(TomlTable& table, ident::CableTest& test) {
  auto& cable = test.cable;
  cable.length_m = with_std(table, "length", table.number("length", Bound::positive, "m"), "m");
  cable.mass_per_length = with_std(
      table, "mass_per_length", table.number("mass_per_length", Bound::positive, "kg/m"), "kg/m");
  const auto of = table.choice_or("mass_of", {"", "installed", "unstretched"}, "");
  if (of == "installed") cable.mass_reference = ident::MassReference::installed;
  if (of == "unstretched") cable.mass_reference = ident::MassReference::unstretched;
  cable.EI_Nm2 = optional_with_std(table, "EI", "N m2");
  cable.EA_N = optional_with_std(table, "EA", "N");
  cable.inclination_deg = table.number_or("inclination", Bound::any, "degrees", 0);
  if (!(std::abs(cable.inclination_deg) <= 90)) {
    throw table.error("inclination", "is beyond 90 degrees", "0 is horizontal, 90 a hanger");
  }
  auto& options = test.options;
  options.ends = ident::cable_ends(table.choice_or(
      "ends", {ident::kCableEndsWords.begin(), ident::kCableEndsWords.end()}, "compare"));
  const auto probability = [&table](const char* key, double otherwise) {
    const double value = table.number_or(key, Bound::positive, "", otherwise);
    if (!(value >= 0.001 && value <= 0.9)) {
      throw table.error(key, "is no probability of 0.001 to 0.9", "leave it out where not known");
    }
    return value;
  };
  options.missed = probability("missed", options.missed);
  options.false_mode = probability("false", options.false_mode);
}

}  // namespace

void CampaignTestReader::read_tension(TomlTable& table, CampaignTest& test) {
  ident::TensionInputs inputs;
  inputs.test.name = test.name;
  read_cable(table, inputs.test);
  const auto plane = table.choice_or("plane", {"any", "in", "out"}, "any");
  if (plane == "in") inputs.plane = model::ModePlane::in;
  if (plane == "out") inputs.plane = model::ModePlane::out;
  if (table.has("measured")) {
    const auto file = folder_ / table.string("measured");
    campaign_.inputs.push_back(file.string());
    for (auto& row : read_measured_modes(file, table.string_or("column", ""), inputs.plane, {})) {
      inputs.test.modes.push_back(std::move(row.mode));
    }
  }
  if (table.has("frequencies")) {
    const double std = table.number_or("frequency_std", Bound::positive, "Hz", std::nan(""));
    const auto frequencies = table.numbers("frequencies", 1, 200, Bound::positive, "Hz");
    const auto count = static_cast<int>(frequencies.size());
    std::vector<double> orders(frequencies.size(), 0);
    if (table.has("orders")) orders = table.numbers("orders", count, count, Bound::positive, "");
    for (std::size_t i = 0; i < frequencies.size(); ++i) {
      ident::MeasuredMode mode;
      mode.frequency_hz = {frequencies[i], std};
      mode.order = static_cast<int>(std::lround(orders[i]));
      mode.plane = inputs.plane;
      inputs.test.modes.push_back(std::move(mode));
    }
  }
  if (table.has("recording")) {
    if (table.has("channels")) inputs.channels = table.string_or_strings("channels");
    if (table.has("band")) {
      const auto band = table.numbers("band", 2, 2, Bound::not_negative, "Hz");
      if (!(band[0] < band[1])) {
        throw table.error("band", "does not rise", "give the lower frequency first, in Hz");
      }
      inputs.band_low_hz = band[0];
      inputs.band_high_hz = band[1];
    }
    inputs.max_peaks = table.integer_or("max_peaks", 1, 200, inputs.max_peaks);
    read_recordings(table, test);
  } else if (inputs.test.modes.empty()) {
    throw table.error("frequencies", "is missing, and there is no recording",
                      "give frequencies = [...], measured = \"table.csv\" or [[test.recording]]");
  }
  if (table.has("reference")) {
    TomlTable reference = table.table("reference");
    test.reference_name = reference.string_or("name", test.reference_name);
    if (const auto value = reference.optional_number("tension", Bound::positive, "N")) {
      test.reference["tension"] = *value;
    }
    reference.finish();
  }
  test.tension = std::move(inputs);
}

}  // namespace rigfit::apps
