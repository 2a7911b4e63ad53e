#define SUPPLE_SCALAR_LANES
#define SUPPLE_ISA scalar
#include "supple/fem/tet4_kernels_impl.h"

namespace supple::fem {
extern const Tet4Kernels tet4_kernels_scalar;
const Tet4Kernels tet4_kernels_scalar = scalar::kKernels;
}  // namespace supple::fem
