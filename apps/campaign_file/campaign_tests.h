// The tests of a campaign file: each [[test]] table to a CampaignTest. Keys: see campaign.h.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "apps/campaign_file/campaign_types.h"
#include "model/scene/toml_table.h"

namespace rigfit::apps {

/// The `name` of a scene, test or fit; refused when it cannot name a file or is taken.
[[nodiscard]] std::string name_in(model::TomlTable& table, std::set<std::string>& taken);

/// Refuses a parameter name that the scene does not have, at the key that gives it.
void check_parameter(const model::Scene& scene, const std::string& parameter,
                     const model::TomlTable& table, const std::string& key);

class CampaignTestReader {
 public:
  /// Reads tests of `campaign`, whose scenes are there already; adds tables to its inputs.
  CampaignTestReader(Campaign& campaign, std::filesystem::path folder);
  /// Throws model::SceneError.
  [[nodiscard]] CampaignTest read(model::TomlTable& table, const std::string& name);

 private:
  void read_bending(model::TomlTable& table, CampaignTest& test);
  void read_axial(model::TomlTable& table, CampaignTest& test);
  void read_decay(model::TomlTable& table, CampaignTest& test);
  void read_tension(model::TomlTable& table, CampaignTest& test);
  void read_modal(model::TomlTable& table, CampaignTest& test);
  void read_scene_keys(model::TomlTable& table, CampaignTest& test);
  void read_hammer(model::TomlTable& table, CampaignTest& test);
  void read_recordings(model::TomlTable& table, CampaignTest& test);
  void read_results(model::TomlTable& table, CampaignTest& test);
  void check_tensions(model::TomlTable& table, const CampaignTest& test) const;
  [[nodiscard]] std::size_t scene_index(model::TomlTable& table) const;
  [[nodiscard]] std::vector<std::string> parameters(model::TomlTable& table, const std::string& key,
                                                    std::size_t scene) const;
  [[nodiscard]] ResultColumns open_table(model::TomlTable& table);

  Campaign& campaign_;
  std::filesystem::path folder_;
};

}  // namespace rigfit::apps
