// Measured (MEASURED)
#include "mesh_cost.h"

#include <cmath>

namespace supple::demos {

namespace {

constexpr double kFixedMb = 10, kTetKb = 1.5, kHexKb = 8;
constexpr double kTetUs = 1.2, kHexUs = 8;

}  // namespace

MeshCost estimate_cost(const VolumeMesh& mesh) {
    const double tets = double(mesh.tets.size()), hexes = double(mesh.hexes.size());
    return {kFixedMb + (kTetKb * tets + kHexKb * hexes) / 1000, (kTetUs * tets + kHexUs * hexes) / 1000};
}

}  // namespace supple::demos
