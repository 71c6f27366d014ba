/* SPDX-License-Identifier: BSD-2-Clause */
/** A program for the processor, as a shared object beside this one: each time it is loaded its memory is as at a reset. */
#ifndef TWIN_PROGRAM_H
#define TWIN_PROGRAM_H

#include <stdexcept>
#include <string>

#include <dlfcn.h>
#include <unistd.h>

namespace twin {

class Program {
public:
    /** @throws std::runtime_error when it cannot be loaded. */
    explicit Program(const std::string &name)
    {
        char self[4096];
        const ssize_t size = readlink("/proc/self/exe", self, sizeof self);
        const std::string path(self, size > 0 ? size_t(size) : 0);
        object_ = dlopen((path.substr(0, path.rfind('/') + 1) + name).c_str(), RTLD_NOW | RTLD_LOCAL);
        if (!object_)
            throw std::runtime_error(dlerror());
    }
    ~Program() { dlclose(object_); }
    Program(const Program &) = delete;

    /** A function of it. @throws std::runtime_error when there is none. */
    template <class F> F *function(const char *name) const
    {
        void *const found = dlsym(object_, name);
        if (!found)
            throw std::runtime_error(dlerror());
        return reinterpret_cast<F *>(found);
    }

private:
    void *object_;
};

} // namespace twin

#endif
