// brdf.cpp: yours. Three models, three functions each; handout.md has the formulas.
#include "course.h"

// f(wo, wi) in 1/sr, without the cosine; 0 where one of them is below the horizon.
double Diffuse::eval(Vec3 wo, Vec3 wi) const {
    return 0; // TODO
}

// The density with which sample() draws wi, per steradian; 0 where it never does.
double Diffuse::pdf(Vec3 wo, Vec3 wi) const {
    return 0; // TODO
}

// A draw: return {wi, weight, pdf, DIFFUSE}, or Sample() where there is none.
Sample Diffuse::sample(Vec3 wo, double u1, double u2) const {
    return Sample(); // TODO
}

double Metal::eval(Vec3 wo, Vec3 wi) const {
    return 0; // TODO
}

double Metal::pdf(Vec3 wo, Vec3 wi) const {
    return 0; // TODO
}

// The lobe of the metal is GLOSSY.
Sample Metal::sample(Vec3 wo, double u1, double u2) const {
    return Sample(); // TODO
}

double Plastic::eval(Vec3 wo, Vec3 wi) const {
    return 0; // TODO
}

double Plastic::pdf(Vec3 wo, Vec3 wi) const {
    return 0; // TODO
}

// GLOSSY where the coat was drawn from, DIFFUSE where the base was.
Sample Plastic::sample(Vec3 wo, double u1, double u2) const {
    return Sample(); // TODO
}
