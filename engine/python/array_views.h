// NumPy arrays that show C++ memory: read-only, without copies, keeping its owner alive.
#pragma once

#include <pybind11/numpy.h>

#include <array>
#include <cstddef>
#include <vector>

namespace ricci::python {

/// An array of `shape` over `data` with `strides` in bytes (empty: one after the other). `owner` must keep
/// `data` where it is for as long as it lives.
template <class T>
pybind11::array view_of(const T* data, std::vector<pybind11::ssize_t> shape,
                        std::vector<pybind11::ssize_t> strides, pybind11::handle owner) {
    pybind11::array array(pybind11::dtype::of<T>(), std::move(shape), std::move(strides), data, owner);
    pybind11::detail::array_proxy(array.ptr())->flags &= ~pybind11::detail::npy_api::NPY_ARRAY_WRITEABLE_;
    return array;
}

template <class T>
pybind11::array view_of(const std::vector<T>& values, pybind11::handle owner) {
    return view_of(values.data(), {static_cast<pybind11::ssize_t>(values.size())}, {}, owner);
}

/// (n, columns)
template <class T, std::size_t columns>
pybind11::array view_of(const std::vector<std::array<T, columns>>& rows, pybind11::handle owner) {
    static_assert(sizeof(std::array<T, columns>) == columns * sizeof(T));
    return view_of(reinterpret_cast<const T*>(rows.data()),
                   {static_cast<pybind11::ssize_t>(rows.size()), static_cast<pybind11::ssize_t>(columns)}, {},
                   owner);
}

/// One member of every struct in a list. // n
template <class Row, class T>
pybind11::array view_of(const std::vector<Row>& rows, T Row::*member, pybind11::handle owner) {
    const T* first = rows.empty() ? nullptr : &(rows.front().*member);
    return view_of(first, {static_cast<pybind11::ssize_t>(rows.size())},
                   {static_cast<pybind11::ssize_t>(sizeof(Row))}, owner);
}

}  // namespace ricci::python
