// Element-wise loops over whole arrays of entries: plain arithmetic that the compiler turns into
// full vectors, compiled for AVX2 and AVX-512 too where the machine has them (without fused
// multiply-add, so that the numbers are the same everywhere).
#pragma once

namespace rigfit::model {

/// out = x + factor y; `out` may be x.
void add_multiple(int n, const double* x, double factor, const double* y, double* out);
/// y += A x, A of rows x columns stored column after column.
void add_product(int rows, int columns, const double* A, const double* x, double* y);

}  // namespace rigfit::model
