#pragma once
#include "supple/fem/elements.h"
#include "supple/fem/tet4_hyper.h"

namespace supple::fem {

/// Parameters of a hyperelastic law in the layout of the kernels.
struct HyperParameters {
    Law law = Law::neo_hookean;
    std::size_t count = 0;          ///< per element: the stiffness of the inversion, then the law's
    AlignedVector<double> field;    ///< [block][count][lane]
};

/// The elements of a group have one law, each its own numbers.
HyperParameters make_hyper_parameters(const ElementGroup& group, const ElementMaterials& materials);

}  // namespace supple::fem
