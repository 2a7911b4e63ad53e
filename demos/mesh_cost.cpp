// Measured on one thread of an AMD EPYC (AVX-512) whose cores were shared with other work, h = 1/60 s, tolerance 1e-5, nu = 0.4: processor time of the step and growth of
// the resident memory by template, world and solver.
//     bars of 4n x n x n cells, E = 2e5 Pa     5,184 tets   1.8 KB and 0.50 us a tet        41,472 tets   1.3 KB and 0.85 us a tet        6,912 hexes  7.4 KB and 6.8 us a hex
//     real bodies 0.2 m long, held by one end, E = 1e4 and 2e5 Pa:
//                                              1,493 tets   3.1 KB and 0.7 us a tet          8,418 tets   2.4 KB and 1.7 (2e5), 3.7 us a tet (1e4: it bends double)
//                                             19,379 tets   1.7 KB and 1.6 to 2.1 us a tet   5,176 hexes  8 to 12 KB and 7.1 to 7.3 us a hex
// A tet's share grows with the mesh, as the solver's iterations do and the caches fail; a hex costs so much itself that it hides this.
#include "mesh_cost.h"

#include <algorithm>
#include <cmath>

namespace supple::demos {

namespace {

constexpr double kBaseMb = 2, kTetKb = 1.6, kHexKb = 7.8;
constexpr double kTetUs = 0.42, kTetGrowth = 0.35;  // of a mesh of 1000 tets; exponent of their number
constexpr double kHexUs = 6.8;

}  // namespace

MeshCost estimate_cost(const VolumeMesh& mesh) {
    const auto tets = double(mesh.tets.size()), hexes = double(mesh.hexes.size());
    return {kBaseMb + (kTetKb * tets + kHexKb * hexes) / 1000, (kTetUs * std::pow(std::max(tets, 1.0) / 1000, kTetGrowth) * tets + kHexUs * hexes) / 1000};
}

}  // namespace supple::demos
