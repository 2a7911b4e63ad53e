#define SUPPLE_ISA avx2
#include "supple/fem/tet4_hyper_kernels_impl.h"

namespace supple::fem {
extern const Tet4HyperKernels tet4_hyper_kernels_avx2;
const Tet4HyperKernels tet4_hyper_kernels_avx2 = avx2::kHyperKernels;
}  // namespace supple::fem
