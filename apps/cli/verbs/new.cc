#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "apps/campaign_file/new_campaign.h"
#include "apps/cli/output_file.h"
#include "apps/cli/verbs/all.h"

namespace rigfit::apps {
namespace fs = std::filesystem;

void add_new(CLI::App& program, Verbs& verbs) {
  auto folder = std::make_shared<std::string>();
  CLI::App* app =
      program.add_subcommand("new", "Writes a commented campaign to start from, with an example");
  app->add_option("folder", *folder, "Folder to make")->required()->type_name("DIR");
  app->footer("Example:\n  rigfit new my-rig && rigfit report my-rig/campaign.toml --out report");
  verbs.push_back(
      {app, [folder](VerbContext& context) {
         const fs::path root = *folder;
         for (const auto& [name, content] : new_campaign_files()) {
           std::error_code error;
           if (fs::exists(root / name, error)) {
             throw UsageError((root / name).string() + " exists already; name a folder of its own");
           }
         }
         Json files = Json::array();
         for (const auto& [name, content] : new_campaign_files()) {
           const fs::path path = root / name;
           make_output_folder(path.parent_path());
           write_whole_file(path, content);
           files.push_back(path.string());
         }
         context.out << fmt::format("wrote {}\nnext: rigfit report {} --out {}\n",
                                    (root / "campaign.toml").string(),
                                    (root / "campaign.toml").string(), (root / "report").string());
         return Json{{"files", std::move(files)}};
       }});
}

}  // namespace rigfit::apps
