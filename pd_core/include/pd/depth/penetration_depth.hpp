/// @file
/// The main call: penetration depth of two convex bodies in R^3, with a proof.
///
/// P = B + (-A) is the Minkowski difference, and pi(A, B) the length of the shortest t after which int(A + t) and B
/// are disjoint. It is the distance from the origin to the boundary of P when the origin lies in int P, and 0
/// otherwise. A moves, B
/// stays. Every engine answers with the same type, so that engines are compared by running them.
///
/// [A] Agarwal, Guibas, Har-Peled, Rabinovitch, Sharir, "Penetration depth of two convex polytopes in 3D", 2000.
#pragma once

#include "pd/depth/depth_answer.hpp"
#include "pd/shape/convex_shape.hpp"

namespace pd {

class Scratch;
class WarmCertificate;

/// Penetration depth, or distance when apart, of two posed convex bodies.
///
/// Class: exact for (rounded) polytopes on the stored numbers and poses; for smooth bodies `touching` covers
/// |signed distance| <= 1e-12 L. Depth: exact for (rounded) polytopes (bracket as `settings.bracket` says), certified
/// (1 + delta) for smooth bodies (`settings.delta`, 1e-6 when 0), or to what the budget leaves (`bracket_reached`).
///
/// Deterministic: the same bits for every run, thread count, order of input vertices and instruction set. Swapping A
/// and B negates translation and normal (except for equal point sets, where the least direction is not unique).
///
/// @param scratch  buffers, one per thread; nothing is allocated once they have grown.
/// @param warm     the memory of this pair, or nullptr: the next answer starts from the last surface.
/// Requires a method that supports the two shapes (`supports`), delta in [0, 1].
/// Time: measured near-linear at worst, logarithmic for shallow contacts. Budget: 16,384 supports for smooth bodies.
[[nodiscard]] PenetrationDepth penetration_depth(const PosedShape& a, const PosedShape& b, Scratch& scratch,
                                                 const DepthSettings& settings = {}, WarmCertificate* warm = nullptr);

/// True if the engine answers for these two shapes (the table of methods in the documentation of the line protocol).
[[nodiscard]] bool supports(Method method, const ConvexShape& a, const ConvexShape& b);

}  // namespace pd
