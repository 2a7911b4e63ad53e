#pragma once
#include <array>
#include <span>
#include <vector>

#include "supple/fem/recovery.h"
#include "supple/material/material.h"
#include "supple/world/body_template.h"

namespace supple {

/// Which strain the stress of a linear or corotational element is made of. A hyperelastic law has one stress, sigma = P F^T / J, whatever is asked.
enum class StrainMeasure {
    corotational,  ///< what the forces are made of: sigma = R (2 mu e + lambda tr(e) I) R^T, e = sym(R^T F) - I (`linear`: R = I)
    green,         ///< the full Green strain E = (F^T F - I)/2 under the same moduli: sigma = F (2 mu E + lambda tr(E) I) F^T / J;
                 ///< the whole strain, what has flowed of it included
};

enum class StressAt { vertex, element };

struct StressDef {
    StrainMeasure strain = StrainMeasure::corotational;
    Recovery recovery = Recovery::volume_weighted;  ///< at vertices; the tensor is recovered, and all else made of it
    StressAt at = StressAt::vertex;
    bool directions = false;                        ///< also principal directions
};

/// Cauchy stress at every vertex or element [Pa], in the order of the mesh; zero at a vertex of no element.
struct StressField {
    std::vector<Voigt> cauchy_pa;
    std::vector<double> von_mises_pa;
    std::vector<std::array<double, 3>> principal_pa;  ///< descending
    std::vector<Mat3> directions;                     ///< columns: unit vectors of the three, right-handed; empty unless asked for
};

/// von Mises stress sqrt(3/2 s:s), s the deviator of a Cauchy tensor [Pa].
double von_mises(const Voigt& cauchy);

/// Principal stresses, descending [Pa]; `directions` (may be null) gets their unit vectors as columns, right-handed.
/// A tensor that is not finite gives NaN.
std::array<double, 3> principal_stresses(const Voigt& cauchy, Mat3* directions = nullptr);

/// Stress of a configuration that the caller gives, as evaluate() does it.
/// @param positions_m  one per vertex of the mesh
/// @error Error(invalid_argument) on a wrong count or a non-finite position
StressField evaluate_stress(const BodyTemplate& shape, const Material& material, std::span<const Vec3> positions_m, const StressDef& def = {});

}  // namespace supple
