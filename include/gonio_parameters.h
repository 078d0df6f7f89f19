/* gonio_parameters.h: reads the parameters that gonio_create is given, a flat
 * JSON object of numbers and strings. C99 and C++11; needs no C library and
 * heeds no locale.
 *
 *     double alpha = gonio_number(parameters, "alpha", 0.3);
 *     int v_cavity = gonio_is(parameters, "masking", "v-cavity");
 *     char path[4096];
 *     if (!gonio_text(parameters, "table", path, sizeof path)) ... not there, or too long
 *
 * Text that is no such object (nested, or not JSON) has no parameters. Of a name
 * that is there twice the last one counts. gonio_has, gonio_number, gonio_is and
 * gonio_text are for use, what is called gonio_scan_... is not.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#ifndef GONIO_PARAMETERS_H
#define GONIO_PARAMETERS_H

#include <stddef.h>

static inline const char *gonio_scan_space(const char *s)
{
    while (*s == ' ' || *s == '\t' || *s == '\n' || *s == '\r') {
        ++s;
    }
    return s;
}

static inline int gonio_scan_is_digit(char c)
{
    return c >= '0' && c <= '9';
}

/* The end of the digits at s; s if there are none. */
static inline const char *gonio_scan_digits(const char *s)
{
    while (gonio_scan_is_digit(*s)) {
        ++s;
    }
    return s;
}

/* The four hexadecimal digits at s, or -1. */
static inline long gonio_scan_hex(const char *s)
{
    long value = 0;
    int k;
    for (k = 0; k < 4; ++k) {
        const char c = s[k];
        if (gonio_scan_is_digit(c)) {
            value = 16 * value + (c - '0');
        } else if (c >= 'a' && c <= 'f') {
            value = 16 * value + (c - 'a' + 10);
        } else if (c >= 'A' && c <= 'F') {
            value = 16 * value + (c - 'A' + 10);
        } else {
            return -1;
        }
    }
    return value;
}

/* One character of a string at s, decoded to 1 to 4 bytes; what follows it, or
 * NULL where it is broken. The closing quote gives no bytes and is not passed. */
static inline const char *gonio_scan_character(const char *s, char bytes[4], int *count)
{
    long code, low;
    *count = 0;
    if (*s == '"') {
        return s;
    }
    if ((unsigned char)*s < 0x20) {
        return NULL; /* a control character, or the end of the text */
    }
    *count = 1;
    bytes[0] = *s;
    if (*s != '\\') {
        return s + 1;
    }
    switch (s[1]) {
    case '"':
    case '\\':
    case '/': bytes[0] = s[1]; return s + 2;
    case 'b': bytes[0] = '\b'; return s + 2;
    case 'f': bytes[0] = '\f'; return s + 2;
    case 'n': bytes[0] = '\n'; return s + 2;
    case 'r': bytes[0] = '\r'; return s + 2;
    case 't': bytes[0] = '\t'; return s + 2;
    case 'u': break;
    default: return NULL;
    }
    code = gonio_scan_hex(s + 2);
    s += 6;
    if (code < 0 || (code >= 0xDC00 && code <= 0xDFFF)) {
        return NULL;
    }
    if (code >= 0xD800 && code <= 0xDBFF) { /* the first of a pair */
        low = s[0] == '\\' && s[1] == 'u' ? gonio_scan_hex(s + 2) : -1;
        if (low < 0xDC00 || low > 0xDFFF) {
            return NULL;
        }
        code = 0x10000 + ((code - 0xD800) << 10) + (low - 0xDC00);
        s += 6;
    }
    if (code < 0x80) {
        bytes[0] = (char)code;
    } else if (code < 0x800) {
        bytes[0] = (char)(0xC0 | (code >> 6));
        bytes[1] = (char)(0x80 | (code & 0x3F));
        *count = 2;
    } else if (code < 0x10000) {
        bytes[0] = (char)(0xE0 | (code >> 12));
        bytes[1] = (char)(0x80 | ((code >> 6) & 0x3F));
        bytes[2] = (char)(0x80 | (code & 0x3F));
        *count = 3;
    } else {
        bytes[0] = (char)(0xF0 | (code >> 18));
        bytes[1] = (char)(0x80 | ((code >> 12) & 0x3F));
        bytes[2] = (char)(0x80 | ((code >> 6) & 0x3F));
        bytes[3] = (char)(0x80 | (code & 0x3F));
        *count = 4;
    }
    return s;
}

/* What follows the string at s, or NULL; whether it is `text` (which may be NULL). */
static inline const char *gonio_scan_string(const char *s, const char *text, int *same)
{
    char bytes[4];
    int count, k;
    *same = text != NULL;
    if (*s != '"') {
        return NULL;
    }
    ++s;
    while (*s != '"') {
        s = gonio_scan_character(s, bytes, &count);
        if (s == NULL) {
            return NULL;
        }
        for (k = 0; k < count && *same; ++k) {
            /* A \u0000 is not the end of `text`. */
            *same = *text != 0 && *text++ == bytes[k];
        }
    }
    *same = *same && *text == 0;
    return s + 1;
}

/* What follows the number at s, or NULL if that is none of JSON's. */
static inline const char *gonio_scan_number(const char *s)
{
    const char *digits;
    s += *s == '-';
    digits = s;
    s = gonio_scan_digits(s);
    if (s == digits || (*digits == '0' && s - digits > 1)) {
        return NULL;
    }
    if (*s == '.') {
        digits = ++s;
        s = gonio_scan_digits(s);
        if (s == digits) {
            return NULL;
        }
    }
    if (*s == 'e' || *s == 'E') {
        ++s;
        s += *s == '+' || *s == '-';
        digits = s;
        s = gonio_scan_digits(s);
        if (s == digits) {
            return NULL;
        }
    }
    return s;
}

/* The value of the parameter called `name`, or NULL. The whole text is read, so
 * that a broken one has no parameters at all. */
static inline const char *gonio_scan_find(const char *parameters, const char *name)
{
    const char *s = parameters, *value, *found = NULL;
    char separator;
    int same, unused;
    if (s == NULL || *(s = gonio_scan_space(s)) != '{') {
        return NULL;
    }
    s = gonio_scan_space(s + 1);
    if (*s == '}') {
        return NULL;
    }
    do {
        s = gonio_scan_string(s, name, &same);
        if (s == NULL || *(s = gonio_scan_space(s)) != ':') {
            return NULL;
        }
        value = gonio_scan_space(s + 1);
        s = *value == '"' ? gonio_scan_string(value, NULL, &unused) : gonio_scan_number(value);
        if (s == NULL) {
            return NULL;
        }
        if (same) {
            found = value;
        }
        s = gonio_scan_space(s);
        separator = *s;
        if (separator != ',' && separator != '}') {
            return NULL;
        }
        s = gonio_scan_space(s + 1);
    } while (separator == ',');
    return *s == 0 ? found : NULL;
}

/* 0.d0 d1 d2 ... times 10^point, d0 != 0. More digits than a double can ask for
 * (767) are told by a last one that is not 0. */
typedef struct {
    unsigned char digit[800];
    int count, point;
} gonio_scan_decimal;

static inline void gonio_scan_append(gonio_scan_decimal *x, int digit)
{
    if (x->count < (int)sizeof x->digit) {
        x->digit[x->count++] = (unsigned char)digit;
    } else if (digit != 0 && x->digit[x->count - 1] == 0) {
        x->digit[x->count - 1] = 1;
    }
}

static inline void gonio_scan_halve(gonio_scan_decimal *x)
{
    int k, rest = 0, to = 0;
    const int count = x->count;
    for (k = 0; k < count; ++k) {
        const int value = 10 * rest + x->digit[k];
        rest = value % 2;
        if (to == 0 && value < 2) { /* a leading zero */
            --x->point;
        } else {
            x->digit[to++] = (unsigned char)(value / 2);
        }
    }
    x->count = to;
    if (rest != 0) {
        gonio_scan_append(x, 5);
    }
}

static inline void gonio_scan_double(gonio_scan_decimal *x)
{
    int k, carry = 0, last;
    for (k = x->count - 1; k >= 0; --k) {
        const int value = 2 * x->digit[k] + carry;
        x->digit[k] = (unsigned char)(value % 10);
        carry = value / 10;
    }
    if (carry != 0) {
        last = x->digit[x->count - 1];
        for (k = x->count - 1; k > 0; --k) {
            x->digit[k] = x->digit[k - 1];
        }
        x->digit[0] = 1;
        ++x->point;
        gonio_scan_append(x, last);
    }
}

/* The number at s, which is one of JSON's, to the nearest double (ties to even). */
static inline double gonio_scan_value(const char *s)
{
    gonio_scan_decimal x;
    const int negative = *s == '-';
    int exponent = 0, sign = 1, fraction = 0, two = 0, bits, k;
    unsigned long long mantissa = 0;
    double value;
    x.count = x.point = 0;
    for (s += negative; gonio_scan_is_digit(*s) || *s == '.'; ++s) {
        if (*s == '.') {
            fraction = 1;
            continue;
        }
        if (x.count > 0 || *s != '0') {
            gonio_scan_append(&x, *s - '0');
            x.point += !fraction;
        } else {
            x.point -= fraction;
        }
    }
    if (*s == 'e' || *s == 'E') {
        ++s;
        sign = *s == '-' ? -1 : 1;
        for (s += *s == '+' || *s == '-'; gonio_scan_is_digit(*s); ++s) {
            exponent = exponent < 100000000 ? 10 * exponent + (*s - '0') : exponent;
        }
    }
    x.point += sign * exponent;
    if (x.count == 0 || x.point < -330) {
        return negative ? -0.0 : 0.0;
    }
    if (x.point > 310) {
        x.point = 310; /* infinite all the same */
    }
    /* To [1/2, 1) times 2^two, then to as many bits as a double has there. */
    while (x.point > 0) {
        gonio_scan_halve(&x);
        ++two;
    }
    while (x.point < 0 || x.digit[0] < 5) {
        gonio_scan_double(&x);
        --two;
    }
    bits = two < -1021 ? two + 1074 : 53;
    if (bits < 0) {
        return negative ? -0.0 : 0.0;
    }
    for (k = 0; k < bits; ++k) {
        gonio_scan_double(&x);
    }
    for (k = 0; k < x.point; ++k) {
        mantissa = 10 * mantissa + (k < x.count ? x.digit[k] : 0u);
    }
    /* The rest is at, above or below one half. */
    if (x.point < x.count && x.point >= 0 && x.digit[x.point] >= 5) {
        int above = x.digit[x.point] > 5;
        for (k = x.point + 1; k < x.count; ++k) {
            above = above || x.digit[k] != 0;
        }
        mantissa += above || mantissa % 2 == 1;
    }
    value = (double)mantissa;
    for (two -= bits; two > 0; --two) {
        value *= 2.0;
    }
    for (; two < 0; ++two) {
        value *= 0.5;
    }
    return negative ? -value : value;
}

/* Whether the parameter called `name` is there. */
static inline int gonio_has(const char *parameters, const char *name)
{
    return gonio_scan_find(parameters, name) != NULL;
}

/* The number called `name`; `otherwise` if there is none. */
static inline double gonio_number(const char *parameters, const char *name, double otherwise)
{
    const char *value = gonio_scan_find(parameters, name);
    return value == NULL || *value == '"' ? otherwise : gonio_scan_value(value);
}

/* Whether the string called `name` is there and equals `text`. */
static inline int gonio_is(const char *parameters, const char *name, const char *text)
{
    const char *value = gonio_scan_find(parameters, name);
    int same = 0;
    return value != NULL && gonio_scan_string(value, text, &same) != NULL && same;
}

/* Writes the string called `name` into `text`, which has room for `size` bytes,
 * and a 0 behind it. Returns 0, and writes "", if there is none, if it is too
 * long, or if it contains a 0. */
static inline int gonio_text(const char *parameters, const char *name, char *text, size_t size)
{
    const char *s = gonio_scan_find(parameters, name);
    char bytes[4];
    size_t used = 0;
    int count, k;
    if (size == 0) {
        return 0;
    }
    text[0] = 0;
    if (s == NULL || *s != '"') {
        return 0;
    }
    for (++s; *s != '"';) {
        s = gonio_scan_character(s, bytes, &count);
        for (k = 0; k < count; ++k) {
            if (bytes[k] == 0 || used + 1 >= size) {
                text[0] = 0;
                return 0;
            }
            text[used++] = bytes[k];
        }
    }
    text[used] = 0;
    return 1;
}

#endif
