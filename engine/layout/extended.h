// Real numbers of more digits, for groups whose elements reach far: a matrix of displacement 2R loses e^(2R).
#pragma once

#include <boost/multiprecision/mpfr.hpp>

namespace ricci {

template <unsigned digits>
using Extended = boost::multiprecision::number<
    boost::multiprecision::mpfr_float_backend<digits, boost::multiprecision::allocate_stack>,
    boost::multiprecision::et_off>;

}  // namespace ricci
