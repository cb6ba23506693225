// The reader of TOML tables (document/toml_table.h), as scenes use it.
#pragma once

#include "document/toml_table.h"
#include "model/scene/scene_error.h"

namespace rigfit::model {

using document::Bound;
using document::nearest_word;
using document::TomlTable;

}  // namespace rigfit::model
