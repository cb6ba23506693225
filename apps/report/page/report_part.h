// What a report is made of before it is a page or a document: parts, each with blocks for people
// and JSON for programs. Parts are computed apart from each other and know nothing of HTML.
#pragma once

#include <nlohmann/json.hpp>
#include <variant>

#include "apps/describe/sheet.h"
#include "apps/report/drawing/plot.h"
#include "apps/report/page/answer.h"
#include "ident/statistics/finding.h"

namespace rigfit::apps {

using Json = nlohmann::ordered_json;

struct Paragraph {
  enum class Kind { plain, note, warning };
  std::string text;
  Kind kind = Kind::plain;
};

struct Cell {
  Cell() = default;
  Cell(std::string cell_text) : text(std::move(cell_text)) {}
  Cell(const char* cell_text) : text(cell_text) {}
  Cell(std::string cell_text, Origin cell_origin)
      : text(std::move(cell_text)), origin(cell_origin) {}

  std::string text;
  std::optional<Origin> origin;  ///< colours the cell; none: as its column
  bool doubtful = false;
  std::string link;  ///< where it leads to, such as "#fit-beam"; empty: nowhere
};

struct Column {
  std::string name;
  std::optional<Origin> origin = std::nullopt;
  bool numeric = true;
};

struct ReportTable {
  std::string id = {}, caption = {};
  std::vector<Column> columns = {};
  std::vector<std::vector<Cell>> rows = {};
  std::string fold = {};  ///< words on the fold that a long table stands behind; empty: open
};

/// Rows of a described list below those that the table has, the first one with `front` before it.
/// The first list gives the columns. Remarks stand out.
void add_rows(ReportTable& table, std::vector<Cell> front, const describe::Table& rows,
              std::optional<Origin> origin);
/// A described list (apps/describe/sheet.h) as a table of the report.
[[nodiscard]] ReportTable described_table(const std::string& id, const std::string& caption,
                                          const describe::Table& table,
                                          std::optional<Origin> origin = std::nullopt);
/// The single values of a described result.
[[nodiscard]] ReportTable described_table(const std::string& id, const std::string& caption,
                                          const std::vector<describe::Sheet::Line>& lines,
                                          std::optional<Origin> origin = std::nullopt);

/// Figures of one kind for several states: one state is looked at at a time.
struct PlotTab {
  std::string label;
  std::vector<Plot> plots;
};
struct PlotGroup {
  std::string id, title;
  std::vector<PlotTab> tabs;
};

/// A drawing that no axes fit: hits beside each other, a rig, shapes.
struct Picture {
  std::string id, title, caption;
  std::string svg;                   ///< an svg element with its own colours and the page's classes
  std::string csv;                   ///< its data
  double width = 760, height = 440;  ///< size of the svg, px
};

using Block = std::variant<Paragraph, ReportTable, Plot, PlotGroup, Picture>;

/// Adds a block unless there is nothing to be seen: no series, no rows, no tabs.
inline void add(std::vector<Block>& blocks, Block block) {
  const bool empty = std::visit(
      [](const auto& one) {
        if constexpr (requires { one.series; }) return one.series.empty();
        if constexpr (requires { one.rows; }) return one.rows.empty();
        if constexpr (requires { one.tabs; }) return one.tabs.empty();
        return false;
      },
      block);
  if (!empty) blocks.push_back(std::move(block));
}
template <class Any>
void add(std::vector<Block>& blocks, std::vector<Any> more) {
  for (auto& one : more) add(blocks, Block(std::move(one)));
}

/// Calls `use` with every figure and the label of the tab that it stands in.
template <class Use>
void each_figure(const std::vector<Block>& blocks, Use use) {
  for (const auto& block : blocks) {
    if (const auto* plot = std::get_if<Plot>(&block)) use(*plot, std::string());
    if (const auto* picture = std::get_if<Picture>(&block)) use(*picture, std::string());
    if (const auto* group = std::get_if<PlotGroup>(&block)) {
      for (const auto& tab : group->tabs) {
        for (const auto& plot : tab.plots) use(plot, tab.label);
      }
    }
  }
}

/// A line of the summary: a value found, model against test, what was recorded.
struct SummaryItem {
  enum class Kind { result, error, recorded };
  Kind kind = Kind::result;
  std::string label, text;
  std::optional<Origin> origin = std::nullopt;

  [[nodiscard]] const char* kind_word() const {
    return kind == Kind::result ? "result" : kind == Kind::error ? "error" : "recorded";
  }
  [[nodiscard]] std::optional<std::string> origin_word() const {
    return origin ? std::optional<std::string>(word_of(*origin)) : std::nullopt;
  }
  static constexpr auto fields() {
    using T = SummaryItem;
    using describe::field;
    return std::tuple{field("kind", &T::kind_word), field("label", &T::label),
                      field("text", &T::text), field("origin", &T::origin_word)};
  }
};

/// A measured mode and the frequency that a model has for it.
struct ModeOfModel {
  std::string label;  ///< label of the model: "model fitted", "published model, FE"
  Origin origin = Origin::modelled;
  double measured_hz = 0, model_hz = 0;
};

struct ReportPart {
  std::string id, title;
  std::string test;  ///< name of the test whose section it stands in; empty: a section of its own
  std::vector<Block> blocks;
  std::vector<std::string> brief;  ///< ids of figures and tables for the short report
  std::vector<Answer> answers;
  std::vector<SummaryItem> summary;
  std::vector<ident::Finding>
      warnings;  ///< of the document, raised when the parts are put together
  std::vector<ModeOfModel> modes;
  Json json = Json::object();  ///< merged into the document under the part's key
  std::string json_key;        ///< a list in the document that gets `json` appended; empty: none
  /// Path in the report's folder and content of files for other programs.
  std::vector<std::pair<std::string, std::string>> files;
};

}  // namespace rigfit::apps
