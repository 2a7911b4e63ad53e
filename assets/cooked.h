#pragma once
// The assets that our own cook makes: an implicit shape becomes a fine surface, that surface a mesh for simulation, and stays its skin.
#include <string>
#include <vector>

#include "supple/mesh/cook.h"

namespace supple_assets {

/// A place inside of an asset with a name: a region of its elements, and a surface of its own to be drawn through the skin.
struct Inside {
    std::string name;
    double (*shape)(const supple::Vec3&);
};

struct Recipe {
    std::string name;  ///< of the files: NAME.msh, NAME.ply and NAME.INSIDE.ply
    double (*shape)(const supple::Vec3&);
    supple::Vec3 min_m, max_m;  ///< box that holds the shape
    double skin_edge_m;         ///< of the lattice that the surfaces come from
    supple::CookDef cook;
    std::vector<Inside> inside{};
    std::string group{};                             ///< vertices of the boundary, empty = none
    bool (*in_group)(const supple::Vec3&) = nullptr;
};

struct Asset {
    supple::VolumeMesh mesh;                          ///< region NAME, and one per Inside: the elements whose centre lies in it
    supple::mesh::TriangleMesh skin;
    std::vector<supple::mesh::TriangleMesh> inside;  ///< surfaces, as in the recipe
    supple::CookReport report;
};

const std::vector<Recipe>& recipes();

/// The same asset from every team and compiler.
Asset make_asset(const Recipe& recipe, supple::Team& team);

}  // namespace supple_assets
