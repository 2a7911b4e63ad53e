#define SUPPLE_ISA avx512
#include "supple/fem/tet4_hyper_kernels_impl.h"

namespace supple::fem {
extern const Tet4HyperKernels tet4_hyper_kernels_avx512;
const Tet4HyperKernels tet4_hyper_kernels_avx512 = avx512::kHyperKernels;
}  // namespace supple::fem
