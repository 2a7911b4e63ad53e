#pragma once
#include "supple/world/world.h"

namespace supple {

/// When matter tears by itself.
struct TearDef {
    Selection where = Everything{};   ///< vertices at which it may, at rest; made anew on the mesh as it is: not a vertex or element list
    double strength_pa = 0;           ///< largest principal Cauchy stress (volume-weighted, at the vertex) that it bears, > 0
    double max_stretch = 0;           ///< it tears also where a principal stretch of an element at the vertex is above, > 1; 0: never
    double toughness_j_m2 = 0;        ///< energy that a unit of torn area takes, >= 0: below it a stress above the strength does not tear
    int most_per_step = 8;            ///< vertices torn per call, >= 1, each with those neighbours whose faces then reach the surface: the rest waits until the stress has moved on
};

/// Tears a body at the vertices that are strained most, along the faces of its elements nearest to the plane across the largest principal stress there (where the stretch
/// decides, across the largest stretch). Each torn vertex has its elements on both sides of that plane parted; neighbours of a torn vertex wait. Released energy is taken as that of the
/// elements at the vertex, V sigma_1^2 / (2 E). Call it after each step, or every few.
/// @return  what it did to the mesh; the identity where nothing tore
/// @error   Error(invalid_argument) naming the field
/// @source  the plane across the largest tension at a node: O'Brien and Hodgins 1999, "Graphical modeling and animation of brittle fracture"
TopologyDelta tear_overstressed(World& world, BodyId body, const TearDef& def);

}  // namespace supple
