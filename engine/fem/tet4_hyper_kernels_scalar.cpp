#define SUPPLE_SCALAR_LANES
#define SUPPLE_ISA scalar
#include "supple/fem/tet4_hyper_kernels_impl.h"

namespace supple::fem {
extern const Tet4HyperKernels tet4_hyper_kernels_scalar;
const Tet4HyperKernels tet4_hyper_kernels_scalar = scalar::kHyperKernels;
}  // namespace supple::fem
