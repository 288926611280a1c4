// Real numbers of more digits than the processor has: for deck transformations that reach far (a matrix of
// displacement 2R loses e^(2R)) and for metrics with needles (docs/reliability/numerical_trust.md).
#pragma once

#include <boost/multiprecision/mpfr.hpp>

namespace ricci {

template <unsigned digits>
using Extended = boost::multiprecision::number<
    boost::multiprecision::mpfr_float_backend<digits, boost::multiprecision::allocate_stack>,
    boost::multiprecision::et_off>;

/// What the kernels are instantiated for beside double and long double.
using WideReal = Extended<50>;

}  // namespace ricci
