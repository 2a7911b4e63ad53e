#define SUPPLE_ISA baseline
#include "supple/fem/tet4_hyper_kernels_impl.h"

namespace supple::fem {
extern const Tet4HyperKernels tet4_hyper_kernels_baseline;
const Tet4HyperKernels tet4_hyper_kernels_baseline = baseline::kHyperKernels;
}  // namespace supple::fem
