// The kernels for AVX-512 with VNNI: the plain loops, but for the product of 8-bit numbers.
#include "generate/kernels/attend_vnni.h"

namespace mocaplm {

const Kernels kAvx512Kernels = {product_f32, prepare_bf16, product_bf16, prepare_vnni, product_vnni,
                                attend_f32,  attend_bf16,  attend_vnni,  put_vnni,     layer_norm,
                                store,       store_gelu,   store_sum};

}  // namespace mocaplm
