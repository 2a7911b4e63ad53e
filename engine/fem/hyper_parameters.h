#pragma once
#include "supple/fem/elements.h"
#include "supple/fem/tet4_hyper.h"

namespace supple::fem {

/// Parameters of a hyperelastic law in the layout of the kernels.
struct HyperParameters {
    Law law = Law::neo_hookean;
    std::size_t count = 0;          ///< per element: the stiffness of the inversion, the law's; of a tensor law also its frame
    AlignedVector<double> field;    ///< [block][count][lane]
    std::size_t families = 0;       ///< of fibres
    AlignedVector<double> fibre;    ///< [block][family][kFibre][lane]
};

/// The elements of a group have one law, each its own numbers. Free lanes repeat the last element.
HyperParameters make_hyper_parameters(const ElementGroup& group, const ElementMaterials& materials);

/// Material frame of an element of Costa's law, columns f s n.
Mat3 material_frame(const Fibres& fibres, std::size_t element);

}  // namespace supple::fem
