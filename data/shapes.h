#pragma once

#include "data/dual.h"

namespace umtet {

/// {f = 0} is the surface; f < 0 inside, C-infinity around it, |grad f| of the order of 1 on it.
using ShapeFunction = Dual (*)(const Dual& x, const Dual& y, const Dual& z);

/// A swimming ring (axis y) with neck, head, beak and tail of a duck that looks along x. Genus 1.
Dual duck(const Dual& x, const Dual& y, const Dual& z);

/// A bird that flies along z with its wings spread along x; y is up. Genus 0.
Dual bird(const Dual& x, const Dual& y, const Dual& z);

/// Three tubes around great circles of the unit sphere, one per coordinate plane, grown together where they cross: the
/// graph of an octahedron, 6 knots and 12 arcs. Genus 12 - 6 + 1 = 7.
Dual knot(const Dual& x, const Dual& y, const Dual& z);

/// Torus R = 1, r = 0.4, axis z. Genus 1.
Dual torus(const Dual& x, const Dual& y, const Dual& z);

/// A pear that lies along x from -1 to about 1. Genus 0.
Dual blob(const Dual& x, const Dual& y, const Dual& z);

}  // namespace umtet
