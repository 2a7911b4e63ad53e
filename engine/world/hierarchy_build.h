#pragma once
#include <array>
#include <memory>
#include <vector>

#include "supple/base/background.h"
#include "supple/solve/lattice_multigrid.h"

namespace supple {

/// What a lattice hierarchy of a body is built from, copied so that the body may go on.
template <class Real>
struct HierarchyInputs {
    solve::Bsr3<Real> A;                                   ///< matrix of the build configuration
    std::vector<double> rotation;                          ///< [element][w x y z] there
    std::vector<std::uint8_t> held;                        ///< [vertex]
    std::vector<std::array<std::int32_t, 3>> elements_near;///< [vertex] up to three elements at each, then -1
    double volume = 0;
};

/// A hierarchy under way on a thread of its own.
template <class Real>
struct HierarchyBuild {
    HierarchyInputs<Real> inputs;
    std::unique_ptr<solve::LatticeMultigrid<Real>> result;
    std::unique_ptr<Background> thread;  ///< last: it goes first, and waits
};

}  // namespace supple
