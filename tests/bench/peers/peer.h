#pragma once
#include <array>
#include <string>
#include <vector>

#include "supple/mesh/volume_mesh.h"

namespace supple::peers {

/// The common workload: a bar clamped at x = 0 bends under gravity from rest.
struct Problem {
    VolumeMesh mesh;
    double young_pa = 2e5, poisson = 0.4, density_kg_m3 = 1000, time_step_s = 0.01, gravity_m_s2 = 9.81;
    double tolerance = 1e-5;
    int most_iterations = 200;
    bool is_held(std::size_t vertex) const { return mesh.vertices[vertex].x() < 1e-9; }
    std::vector<double> vertex_mass_kg() const;  ///< a quarter of each tet's
};

/// An engine with that bar in it.
class Peer {
public:
    virtual ~Peer() = default;
    virtual std::string name() const = 0;
    virtual int step() = 0;                          ///< one time step; returns its solver iterations
    virtual Vec3 position(std::size_t vertex) const = 0;
};

}  // namespace supple::peers
