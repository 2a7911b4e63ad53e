#define SUPPLE_ISA baseline
#include "supple/fem/tet4_kernels_impl.h"

namespace supple::fem {
extern const Tet4Kernels tet4_kernels_baseline;
const Tet4Kernels tet4_kernels_baseline = baseline::kKernels;
}  // namespace supple::fem
