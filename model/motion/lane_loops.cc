#include "model/motion/lane_loops.h"

// Compiled without errno, floating-point traps and contraction (CMakeLists.txt): a square root is
// one instruction, a product and a sum are two.
#if defined(__x86_64__)
#define RIGFIT_LANES_WIDER 1
#define RIGFIT_AVX2 __attribute__((target("avx2")))
#define RIGFIT_AVX512 __attribute__((target("avx512f")))
#endif
#define RIGFIT_ALWAYS __attribute__((always_inline))
#define RIGFIT_INLINE inline RIGFIT_ALWAYS
#ifdef __clang__
#define RIGFIT_PARTS _Pragma("unroll")
#else
#define RIGFIT_PARTS _Pragma("GCC unroll 8")
#endif

namespace rigfit::model {
namespace {

// Eight lanes as N vectors of the processor's own width W.
template <int W>
struct Native {
  typedef double type __attribute__((vector_size(W * sizeof(double))));
  typedef type memory __attribute__((aligned(8), may_alias));
};

template <int W>
struct Lanes {
  static constexpr int kParts = kLanes / W;
  using V = typename Native<W>::type;
  V part[kParts];

  static RIGFIT_INLINE Lanes load(const double* p) {
    Lanes out;
    RIGFIT_PARTS
    for (std::ptrdiff_t k = 0; k < kParts; ++k) {
      out.part[k] = *reinterpret_cast<const typename Native<W>::memory*>(p + k * W);
    }
    return out;
  }
  RIGFIT_INLINE void store(double* p) const {
    RIGFIT_PARTS
    for (std::ptrdiff_t k = 0; k < kParts; ++k) {
      *reinterpret_cast<typename Native<W>::memory*>(p + k * W) = part[k];
    }
  }
  static RIGFIT_INLINE Lanes zero() { return {}; }
};

#define RIGFIT_LANE_OPERATOR(op)                                             \
  template <int W>                                                           \
  RIGFIT_INLINE Lanes<W> operator op(const Lanes<W>& a, const Lanes<W>& b) { \
    Lanes<W> out;                                                            \
    RIGFIT_PARTS                                                             \
    for (int k = 0; k < Lanes<W>::kParts; ++k) {                             \
      out.part[k] = a.part[k] op b.part[k];                                  \
    }                                                                        \
    return out;                                                              \
  }
RIGFIT_LANE_OPERATOR(+)
RIGFIT_LANE_OPERATOR(-)
RIGFIT_LANE_OPERATOR(*)
RIGFIT_LANE_OPERATOR(/)
#undef RIGFIT_LANE_OPERATOR

template <int W>
RIGFIT_INLINE Lanes<W> root(const Lanes<W>& a) {
  double x[kLanes];
  a.store(x);
  for (double& value : x) value = std::sqrt(value);
  return Lanes<W>::load(x);
}

// Lane j takes what lane (j + K) % 8 has.
template <int K, int W>
RIGFIT_INLINE Lanes<W> left(const Lanes<W>& a) {
  constexpr int n = Lanes<W>::kParts, q = K / W, r = K % W;
  Lanes<W> out;
  RIGFIT_PARTS
  for (int k = 0; k < n; ++k) {
    const auto& now = a.part[(k + q) % n];
    const auto& behind = a.part[(k + q + 1) % n];
    if constexpr (W == 8) {
      out.part[k] =
          __builtin_shufflevector(now, behind, r, r + 1, r + 2, r + 3, r + 4, r + 5, r + 6, r + 7);
    } else if constexpr (W == 4) {
      out.part[k] = __builtin_shufflevector(now, behind, r, r + 1, r + 2, r + 3);
    } else {
      out.part[k] = __builtin_shufflevector(now, behind, r, r + 1);
    }
  }
  return out;
}

alignas(64) constexpr double kOne[kLanes] = {1, 1, 1, 1, 1, 1, 1, 1};

template <int D, int W>
RIGFIT_INLINE void tangents(const LaneMember& member, std::ptrdiff_t stride,
                            const double* positions, const LaneScratch& scratch) {
  using L = Lanes<W>;
  const int rows = member.rows;
  const L one = L::load(kOne);
  for (int r = 0; r < rows; ++r) {
    const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(r) * kLanes;
    L e[D], square;
    for (int c = 0; c < D; ++c) {
      const double* x = positions + c * stride;
      e[c] = (r + 1 < rows ? L::load(x + at + kLanes) : left<1, W>(L::load(x))) - L::load(x + at);
      square = c == 0 ? e[c] * e[c] : square + e[c] * e[c];
    }
    const L ratio = root<W>(square * L::load(member.inverse_square.data() + at) +
                            L::load(member.pad.data() + at));  // L/l, 1 in padding slots
    const L inverse = L::load(member.inverse_length.data() + at) / ratio;
    (L::load(member.axial.data() + at) * (ratio - one)).store(scratch.tension + at);
    inverse.store(scratch.inverse + at);
    for (int c = 0; c < D; ++c) {
      (e[c] * inverse + L::load(member.fill[c].data() + at)).store(scratch.direction[c] + at);
    }
  }
}

template <int D, int W>
RIGFIT_INLINE void forces(const LaneMember& member, std::ptrdiff_t stride,
                          const LaneScratch& scratch, const double* weight, double* force) {
  using L = Lanes<W>;
  const int rows = member.rows;
  const std::ptrdiff_t end = static_cast<std::ptrdiff_t>(rows - 1) * kLanes;
  L last[D];
  for (int c = 0; c < D; ++c) last[c] = L::zero();
  for (int r = 0; r < rows; ++r) {
    const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(r) * kLanes;
    const L in = L::load(member.joint_before.data() + at),
            out = L::load(member.joint_behind.data() + at);
    const L inverse = L::load(scratch.inverse + at);
    L g[D], along;
    for (int c = 0; c < D; ++c) {
      const double* t = scratch.direction[c];
      const L before = r > 0 ? L::load(t + at - kLanes) : left<7, W>(L::load(t + end));
      const L next = r + 1 < rows ? L::load(t + at + kLanes) : left<1, W>(L::load(t));
      g[c] = (in * before + out * next) * inverse;
      const L own = g[c] * L::load(t + at);
      along = c == 0 ? own : along + own;
    }
    along = along + L::load(scratch.tension + at);
    for (int c = 0; c < D; ++c) {
      const L f = along * L::load(scratch.direction[c] + at) - g[c];
      (f - last[c] + L::load(weight + c * stride + at)).store(force + c * stride + at);
      last[c] = f;
    }
  }
  // The first row lacks what the lane before has in its last.
  for (int c = 0; c < D; ++c) {
    (L::load(force + c * stride) - left<7, W>(last[c])).store(force + c * stride);
  }
}

template <int W>
RIGFIT_INLINE Lanes<W> separated(const LaneFactors& f, const Lanes<W>& z) {
  using L = Lanes<W>;
  const double* inverse = f.separators.data();
  const auto row = [&](std::ptrdiff_t k) RIGFIT_ALWAYS { return L::load(inverse + k * kLanes); };
  return ((row(0) * z + row(1) * left<1, W>(z)) +
          (row(2) * left<2, W>(z) + row(3) * left<3, W>(z))) +
         ((row(4) * left<4, W>(z) + row(5) * left<5, W>(z)) +
          (row(6) * left<6, W>(z) + row(7) * left<7, W>(z)));
}

// The separators' right-hand side comes straight from the forces (the coupling times the inverse of
// a lane's rows is symmetric), so that the chains of dependent operations run side by side.
template <int D, int W>
RIGFIT_INLINE void solve(const LaneFactors* const* factors, std::ptrdiff_t stride, double* values) {
  using L = Lanes<W>;
  const int rows = factors[0]->rows;
  const std::ptrdiff_t end = static_cast<std::ptrdiff_t>(rows - 1) * kLanes;
  L z[D], before[D], last[D];
  for (int c = 0; c < D; ++c) {
    z[c] = L::load(values + c * stride + end);
    before[c] = last[c] = L::zero();
  }
  for (std::ptrdiff_t at = 0; at < end; at += kLanes) {
    for (int c = 0; c < D; ++c) {
      double* y = values + c * stride + at;
      const L f = L::load(y);
      z[c] = z[c] - L::load(factors[c]->from_behind.data() + at) * f;
      before[c] = before[c] + L::load(factors[c]->from_before.data() + at) * f;
      last[c] = f - L::load(factors[c]->toward.data() + at) * last[c];
      last[c].store(y);
    }
  }
  for (int c = 0; c < D; ++c) {
    z[c] = separated<W>(*factors[c], z[c] - left<1, W>(before[c]));
    z[c].store(values + c * stride + end);
    before[c] = left<7, W>(z[c]);
    last[c] = L::zero();
  }
  // Row by row towards the first; `last` without what the separators take.
  for (std::ptrdiff_t at = end - kLanes; at >= 0; at -= kLanes) {
    for (int c = 0; c < D; ++c) {
      double* y = values + c * stride + at;
      last[c] = L::load(y) * L::load(factors[c]->inverse.data() + at) -
                L::load(factors[c]->toward.data() + at + kLanes) * last[c];
      (last[c] - (L::load(factors[c]->from_before.data() + at) * before[c] +
                  L::load(factors[c]->from_behind.data() + at) * z[c]))
          .store(y);
    }
  }
}

// One set of functions for every width.
// NOLINTBEGIN(bugprone-macro-parentheses): an attribute in parentheses is none.
#define RIGFIT_LANE_LOOPS(name, attribute, W)                                                     \
  template <int D>                                                                                \
  attribute void tangents_##name(const LaneMember& member, std::ptrdiff_t stride,                 \
                                 const double* positions, const LaneScratch& scratch) {           \
    tangents<D, W>(member, stride, positions, scratch);                                           \
  }                                                                                               \
  template <int D>                                                                                \
  attribute void forces_##name(const LaneMember& member, std::ptrdiff_t stride,                   \
                               const LaneScratch& scratch, const double* weight, double* force) { \
    forces<D, W>(member, stride, scratch, weight, force);                                         \
  }                                                                                               \
  template <int D>                                                                                \
  attribute void solve_##name(const LaneFactors* const* factors, std::ptrdiff_t stride,           \
                              double* values) {                                                   \
    solve<D, W>(factors, stride, values);                                                         \
  }                                                                                               \
  template <int D>                                                                                \
  constexpr LaneLoops<D> k_##name{tangents_##name<D>, forces_##name<D>, solve_##name<D>};
RIGFIT_LANE_LOOPS(plain, , 2)
#ifdef RIGFIT_LANES_WIDER
RIGFIT_LANE_LOOPS(avx2, RIGFIT_AVX2, 4)
RIGFIT_LANE_LOOPS(avx512, RIGFIT_AVX512, 8)
#endif
#undef RIGFIT_LANE_LOOPS
// NOLINTEND(bugprone-macro-parentheses)

}  // namespace

template <int D>
const LaneLoops<D>& lane_loops([[maybe_unused]] int widest) {
#ifdef RIGFIT_LANES_WIDER
  if (widest >= 8 && __builtin_cpu_supports("avx512f")) return k_avx512<D>;
  if (widest >= 4 && __builtin_cpu_supports("avx2")) return k_avx2<D>;
#endif
  return k_plain<D>;
}

template const LaneLoops<2>& lane_loops<2>(int);
template const LaneLoops<3>& lane_loops<3>(int);

}  // namespace rigfit::model
