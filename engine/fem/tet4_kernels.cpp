#include "supple/base/assert.h"
#include "supple/fem/tet4.h"
#include "supple/fem/tet4_hyper.h"

namespace supple::fem {

extern const Tet4Kernels tet4_kernels_scalar, tet4_kernels_baseline;
#if defined(SUPPLE_X86_KERNELS)
extern const Tet4Kernels tet4_kernels_avx2, tet4_kernels_avx512;
#endif
extern const Tet4HyperKernels tet4_hyper_kernels_scalar, tet4_hyper_kernels_baseline;
#if defined(SUPPLE_X86_KERNELS)
extern const Tet4HyperKernels tet4_hyper_kernels_avx2, tet4_hyper_kernels_avx512;
#endif

const Tet4Kernels& tet4_kernels(Isa isa) {
    SUPPLE_ASSERT(is_supported(isa));
    switch (isa) {
#if defined(SUPPLE_X86_KERNELS)
        case Isa::avx2: return tet4_kernels_avx2;
        case Isa::avx512: return tet4_kernels_avx512;
#endif
        case Isa::scalar: return tet4_kernels_scalar;
        default: return tet4_kernels_baseline;
    }
}

const Tet4HyperKernels& tet4_hyper_kernels(Isa isa) {
    SUPPLE_ASSERT(is_supported(isa));
    switch (isa) {
#if defined(SUPPLE_X86_KERNELS)
        case Isa::avx2: return tet4_hyper_kernels_avx2;
        case Isa::avx512: return tet4_hyper_kernels_avx512;
#endif
        case Isa::scalar: return tet4_hyper_kernels_scalar;
        default: return tet4_hyper_kernels_baseline;
    }
}

}  // namespace supple::fem
