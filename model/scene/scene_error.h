// What is wrong with a scene: the error of every TOML document, with file, line, key and remedy.
#pragma once

#include "document/document_error.h"

namespace rigfit::model {

/// A scene that cannot be used; `what()` is the whole message.
using SceneError = document::DocumentError;

}  // namespace rigfit::model
