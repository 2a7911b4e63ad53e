#define SUPPLE_ISA avx2
#include "supple/solve/bsr3_kernels_impl.h"

namespace supple::solve {
extern const Bsr3Kernels<float> bsr3_kernels_f_avx2;
extern const Bsr3Kernels<double> bsr3_kernels_d_avx2;
const Bsr3Kernels<float> bsr3_kernels_f_avx2 = avx2::kKernels<float>;
const Bsr3Kernels<double> bsr3_kernels_d_avx2 = avx2::kKernels<double>;
}  // namespace supple::solve
