#pragma once
#include <span>
#include <vector>

#include "supple/base/parallel.h"
#include "supple/fem/corners.h"
#include "supple/fem/hex8.h"
#include "supple/fem/tet4.h"
#include "supple/material/material.h"
#include "supple/mesh/volume_mesh.h"

namespace supple::fem {

enum class ElementKind { tet, hex };

/// Elements that one kernel serves: of one kind and one family of laws.
struct ElementGroup {
    ElementKind kind = ElementKind::tet;
    std::int32_t family = 0;
    std::vector<std::int32_t> element;  ///< numbers in the mesh (tets first, then hexes), in the order of their blocks and lanes
    Tet4Rest tets;                      ///< rest shapes of the group's kind; the other is empty
    Hex8Rest hexes;
    std::size_t first_block = 0;        ///< where its blocks begin in the arrays of the body
    CornerSums sums;                    ///< of tets
    std::size_t first_place = 0;        ///< where its forces begin: of tets summed, of hexes corner by corner
    std::size_t corners() const { return kind == ElementKind::tet ? 4 : 8; }
    std::size_t blocks() const { return (element.size() + kBlock - 1) / kBlock; }
};

/// How the numbers of a body's elements lie in its arrays: group after group, each in blocks of eight, neighbours near one another. A body of tets of one law
/// is one group.
struct ElementLayout {
    std::vector<ElementGroup> groups;
    std::size_t elements = 0, vertices = 0;
    std::size_t blocks = 0;             ///< of all groups; rotations, energies and stresses are [block][..][lane]
    std::size_t places = 0;             ///< element corners and sums of them; values are [place][x y z 0]
    std::vector<std::uint32_t> slot;    ///< [element of the mesh] block * 8 + lane
    std::vector<double> volume;         ///< [element of the mesh] [m^3]
    ElementMap around;                  ///< the elements at each vertex
    PlaceMap forces;                    ///< the places at each vertex
};

/// @param family  of each element; empty: all the same
/// @param place   [vertex] in an order that keeps neighbours together: elements lie by the first of their corners there; empty: in the order of the mesh
/// @param mesh    checked (check_and_repair); @error Error(invalid_argument) for a hexahedron that is folded at an integration point
ElementLayout make_layout(const VolumeMesh& mesh, std::span<const std::int32_t> family = {}, std::span<const std::int32_t> place = {});
/// make_layout(mesh, {}, place) after an edit: rest shapes of elements that are the same are copied.
/// @param before       layout of the mesh before, one family
/// @param old_element  [element] the one that it was in the mesh before, or -1
ElementLayout follow_layout(const VolumeMesh& mesh, std::span<const std::int32_t> place, const ElementLayout& before, std::span<const std::int32_t> old_element);

/// Volume of an element that each of its corners carries: a quarter of a tet, the integral of the shape function in a hex [m^3]. They sum to its volume.
/// @param share  out, 4 or 8 numbers. Returns how many.
std::size_t corner_volumes(const VolumeMesh& mesh, std::size_t element, double share[8]);

/// Row-sum lumped mass [kg]. One density for all, or one per element.
std::vector<double> lumped_mass(const VolumeMesh& mesh, std::span<const double> density_kg_m3);

/// Trace of the diagonal stiffness block of each vertex at rest [N/m] (hexes: by full integration). lame: one per element of the mesh.
std::vector<double> stiffness_trace(const ElementLayout& layout, std::span<const Lame> lame);

/// Element rotations of a configuration found afresh, without a starting guess: [block][w x y z][lane].
void seed_rotations(Team& team, const ElementLayout& layout, std::span<const Vec3> positions, AlignedVector<double>& quaternion);

}  // namespace supple::fem
