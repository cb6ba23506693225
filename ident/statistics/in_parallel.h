// The same work for each of several things, on so many threads.
#pragma once

#include <cstddef>
#include <functional>

namespace rigfit::ident {

/// Calls `work` with 0 .. count - 1, each once, in that order of starting. After an exception no
/// further one is started, those before it are finished, and the exception of the lowest comes out.
void in_parallel(std::size_t count, int threads, const std::function<void(std::size_t)>& work);

}  // namespace rigfit::ident
