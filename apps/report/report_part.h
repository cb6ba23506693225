// What a report is made of before it is a page or a document: parts, each with blocks for people
// and JSON for programs. Parts are computed apart from each other and know nothing of HTML.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "apps/report/plot.h"

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
  std::optional<Origin> origin;  ///< colours the cell
  bool doubtful = false;
};

struct Column {
  std::string name;
  std::optional<Origin> origin;
  bool numeric = true;
};

struct ReportTable {
  std::string id, caption;
  std::vector<Column> columns;
  std::vector<std::vector<Cell>> rows;
};

/// Mode shapes in space, drawn and moved by the page.
struct ShapeViewer {
  std::string id, caption;
  Json states;  ///< [{label, modes: [{label, family, plane, frequency_hz, members: [{name, rest:
                ///< [[x,y,z]..], shape: [[x,y,z]..]}]}]}]
};

using Block = std::variant<Paragraph, ReportTable, Plot, ShapeViewer>;

/// A line of the summary: a value found or something to know before trusting the rest.
struct SummaryItem {
  enum class Kind { result, distrust };
  Kind kind = Kind::result;
  std::string label, text;
  std::optional<Origin> origin;
  std::string anchor;  ///< id of the part that says more
};

/// A warning of the document, raised when the parts are put together.
struct PartWarning {
  std::string code, message, where;
  bool refused = false;  ///< ends the run with exit code 4
};

struct ReportPart {
  std::string id, title;
  std::vector<Block> blocks;
  std::vector<SummaryItem> summary;
  std::vector<PartWarning> warnings;
  std::vector<std::string> inputs;  ///< files read for it besides the campaign's own
  Json json = Json::object();       ///< merged into the document under the part's key
  std::string json_key;  ///< a list in the document that gets `json` appended; empty: none
};

}  // namespace rigfit::apps
