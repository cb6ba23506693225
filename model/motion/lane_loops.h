// The loops in which explicit time integration spends its time, over the nodes of one member in
// lane order: the member is cut into eight pieces of `rows` nodes, piece after piece in the eight
// lanes of a vector. Node i stands in row i % rows, lane i / rows, slot 8 row + lane. A node's
// neighbours stand in the same lane of the next rows, and in the next lane at a piece's ends only,
// so that force loops and the solution of tridiagonal systems are full vectors without remainders.
//
// 8 rows >= segments + 2: the slots behind the last node are padding, of which the last (the one
// "before" node 0, cyclically) and the one of node n hold the directions of the end joints' node
// sides. What belongs to a segment stands in the slot of its first node.
//
// Every operation is an addition, multiplication, division or square root of IEEE doubles in a
// fixed order without fused multiply-add: plain x86-64, AVX2 and AVX-512 code (chosen once, by the
// processor) give the same bits.
#pragma once

#include <new>

#include "model/algebra/numbers.h"

namespace rigfit::model {

/// Memory on the boundaries of cache lines: no vector is split over two of them.
template <typename T>
struct LaneAllocator {
  using value_type = T;
  LaneAllocator() = default;
  template <typename U>
  explicit LaneAllocator(const LaneAllocator<U>&) {}
  [[nodiscard]] T* allocate(std::size_t n) {
    return static_cast<T*>(::operator new (n * sizeof(T), std::align_val_t{64}));
  }
  void deallocate(T* p, std::size_t) { ::operator delete (p, std::align_val_t{64}); }
  bool operator==(const LaneAllocator&) const { return true; }
};
using LaneVector = std::vector<double, LaneAllocator<double>>;

inline constexpr int kLanes = 8;

/// Rows of a member of so many segments.
[[nodiscard]] constexpr int lane_rows(int segments) { return (segments + 2 + kLanes - 1) / kLanes; }
/// Slot of a node among the member's 8 rows.
[[nodiscard]] constexpr int lane_slot(int node, int rows) {
  return node % rows * kLanes + node / rows;
}

/// A member's constants, 8 rows of each: zero where there is no segment, but for `pad`.
struct LaneMember {
  int rows = 0;
  LaneVector axial;           ///< EA, N
  LaneVector inverse_length;  ///< 1/l of the unstretched segment
  LaneVector inverse_square;  ///< 1/l^2
  LaneVector pad;             ///< 1 where there is no segment, else 0
  LaneVector joint_before;    ///< N m of the joint at the segment's first node
  LaneVector joint_behind;    ///< and at its second
  LaneVector fill[3];         ///< directions of padding slots, else 0
};

/// What `lane_tangents` leaves, 8 rows of each.
struct LaneScratch {
  double* direction[3] = {};
  double* inverse = nullptr;  ///< 1/L
  double* tension = nullptr;  ///< EA (L - l) / l
};

/// Factors of a symmetric tridiagonal matrix of a member's nodes, in lane order: the last row's
/// eight nodes separate the lanes; the rows before are eliminated in every lane by themselves, the
/// eight separators solved with the inverse of their Schur complement. Nodes that are not part of
/// the matrix have zeros everywhere: their solution is zero.
struct LaneFactors {
  int rows = 0;
  LaneVector toward;       ///< off-diagonal to the row before over that row's pivot
  LaneVector inverse;      ///< inverses of the pivots
  LaneVector separators;   ///< 8 x 8: [8 k + j] of the inverse, row j, column (j + k) % 8
  LaneVector from_before;  ///< inverse of a lane's rows times the coupling to the separator before
  LaneVector from_behind;  ///< and to its own
};
/// Factors of the matrix with these diagonal and off-diagonal elements, nodes in their order
/// (`off[i]` between i and i + 1), of nodes first to last (both included; none if last < first).
[[nodiscard]] LaneFactors lane_factors(const std::vector<double>& diagonal,
                                       const std::vector<double>& off, int first, int last,
                                       int rows);

/// The loops as the processor runs them best. D components; component c of an array of entries
/// begins `stride` behind that of c - 1.
template <int D>
struct LaneLoops {
  /// Directions, 1/L and axial force of every segment.
  void (*tangents)(const LaneMember& member, std::ptrdiff_t stride, const double* positions,
                   const LaneScratch& scratch);
  /// Forces of the segments on the nodes and `weight`: dV/de = N t - (I - t t') g / L of every
  /// segment, g = sum of its joints' stiffness times the neighbour's direction; force[i] = f[i] -
  /// f[i - 1] + weight[i].
  void (*forces)(const LaneMember& member, std::ptrdiff_t stride, const LaneScratch& scratch,
                 const double* weight, double* force);
  /// values = A^-1 values, with factors for each component.
  void (*solve)(const LaneFactors* const* factors, std::ptrdiff_t stride, double* values);
};
/// `widest`: vectors of no more lanes than that (2, 4 or 8), where the processor has them.
template <int D>
[[nodiscard]] const LaneLoops<D>& lane_loops(int widest = kLanes);

}  // namespace rigfit::model
