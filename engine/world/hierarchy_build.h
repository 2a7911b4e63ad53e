#pragma once
#include <array>
#include <memory>
#include <vector>

#include "supple/base/background.h"
#include "supple/solve/lattice_multigrid.h"

namespace supple {

/// A hierarchy under way on a thread of its own. It reads what is constant of the body - template, layout, materials, masses - and has copies of what moves.
template <class Real>
struct HierarchyBuild {
    std::vector<Vec3> x;              ///< configuration that it is built from
    std::vector<std::uint8_t> held;   ///< [vertex] there
    std::unique_ptr<solve::LatticeMultigrid<Real>> result;
    std::unique_ptr<Background> thread;  ///< last: it goes first, and waits
};

}  // namespace supple
