#pragma once
#include "supple/fem/tet4_hyper.h"
#include "supple/material/material.h"

namespace supple::fem {

/// Parameters of a hyperelastic law in the layout of the kernels.
struct HyperParameters {
    Law law = Law::neo_hookean;
    std::size_t count = 0;          ///< per element: the stiffness of the inversion, then the law's
    AlignedVector<double> field;    ///< [block][count][lane]
};

HyperParameters make_hyper_parameters(const Tet4Rest& rest, const Material& material);

}  // namespace supple::fem
