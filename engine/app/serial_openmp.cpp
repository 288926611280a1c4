// CHOLMOD's supernodal factorisation opens an OpenMP region per supernode. Even with one thread, libgomp then
// sets up a team and makes a futex system call for every region: two to three times the time of the
// factorisation itself on meshes of some ten thousand vertices (measured, CHOLMOD 3.0.14, GCC 12). This
// program runs one worker per processor already and has no OpenMP region of its own, so it gives the entry
// point a definition that calls the region's body directly: a team of one.
//
// For this executable, and for the Python module, where it is found by the libraries that are loaded with the
// module and by nobody else: never part of a library, whose users may have parallel regions that are to be
// parallel.
#ifdef RICCI_HAS_CHOLMOD

extern "C" __attribute__((visibility("default"))) void GOMP_parallel(void (*body)(void*), void* data,
                                                                     unsigned /*threads*/,
                                                                     unsigned /*flags*/) {
    body(data);
}

#endif
