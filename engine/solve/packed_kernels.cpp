#include "supple/solve/packed_kernels.h"

namespace supple::solve {

extern const PackedKernels packed_kernels_scalar, packed_kernels_baseline;
#if defined(SUPPLE_X86_KERNELS)
extern const PackedKernels packed_kernels_avx2, packed_kernels_avx512;
#endif

const PackedKernels& packed_kernels(Isa isa) {
    switch (isa) {
#if defined(SUPPLE_X86_KERNELS)
        case Isa::avx2: return packed_kernels_avx2;
        case Isa::avx512: return packed_kernels_avx512;
#endif
        case Isa::scalar: return packed_kernels_scalar;
        default: return packed_kernels_baseline;
    }
}

}  // namespace supple::solve
