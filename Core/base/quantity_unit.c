/* SPDX-License-Identifier: BSD-3-Clause
 * Units of the numbers of rays, as text in the form of the CF conventions: symbols with exponents, "kg m-2". */
#include "stratus/quantities.h"

#include <ctype.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FACTORS_MOST 16

/* A power of a symbol, whose text is the caller's. */
typedef struct factor {
  const char* symbol;
  int length, exponent;
} factor;

static bool is_symbol(char c)
{
  return isalpha((unsigned char)c) || c == '%' || c == '_' || (unsigned char)c >= 0x80;
}

/* Reads an exponent: "-2", "^-2", "**-2"; 1 where there is none. */
static int read_exponent(const char** at)
{
  const char* p = *at + (**at == '^' ? 1 : strncmp(*at, "**", 2) == 0 ? 2 : 0);
  const char* digits = p + (*p == '-' || *p == '+' ? 1 : 0);
  if (!isdigit((unsigned char)*digits)) {
    return 1;
  }
  char* end = NULL;
  const long exponent = strtol(p, &end, 10);
  *at = end;
  return exponent > 99 ? 99 : exponent < -99 ? -99 : (int)exponent;
}

/* Reads "kg/m3", "W m-2 sr-1", "kg.m^-3", "1". Returns the number of factors, or -1 for text of another form. */
static int read_factors(const char* text, factor factors[FACTORS_MOST])
{
  int count = 0, sign = 1;
  for (const char* p = text; *p;) {
    if (isspace((unsigned char)*p) || *p == '.' || *p == '*') {
      ++p;
    } else if (*p == '/' && sign > 0) {
      sign = -1;
      ++p;
    } else if (*p == '1' && (p[1] == '\0' || p[1] == '/' || p[1] == ' ')) {
      sign = 1;
      ++p;
    } else if (is_symbol(*p) && count < FACTORS_MOST - 1) { /* the last is for the length */
      factor* f = &factors[count++];
      f->symbol = p;
      while (is_symbol(*p)) {
        ++p;
      }
      f->length = (int)(p - f->symbol);
      f->exponent = sign * read_exponent(&p);
      sign = 1;
    } else {
      return -1;
    }
  }
  return sign > 0 ? count : -1;
}

static void append(char* text, size_t size, const char* symbol, int length, int exponent)
{
  const size_t used = strlen(text);
  char power[16] = "";
  if (exponent != 1) {
    snprintf(power, sizeof power, "%d", exponent);
  }
  if (exponent != 0) {
    snprintf(text + used, size - used, "%s%.*s%s", used > 0 ? " " : "", length, symbol, power);
  }
}

static void write_over_metres(const char* values, char* text, size_t size)
{
  factor factors[FACTORS_MOST];
  int count = read_factors(values, factors), n = 0;
  if (count < 0) {
    const bool simple = strpbrk(values, " /*.") == NULL;
    snprintf(text, size, simple ? "%s m" : "(%s) m", values);
    return;
  }
  while (n < count && !(factors[n].length == 1 && factors[n].symbol[0] == 'm')) {
    ++n;
  }
  if (n == count) {
    factors[count++] = (factor){ "m", 1, 0 };
  }
  ++factors[n].exponent;
  for (int f = 0; f < count; ++f) {
    append(text, size, factors[f].symbol, factors[f].length, factors[f].exponent);
  }
  if (text[0] == '\0') {
    snprintf(text, size, "1");
  }
}

void stratus_quantity_unit(stratus_quantity quantity, const char* values, int metres, char* text, size_t size)
{
  const char* of_values = values ? values : "";
  if (!text || size == 0) {
    return;
  }
  text[0] = '\0';
  switch (quantity) {
    case STRATUS_QUANTITY_INTEGRAL:
      if (of_values[0] != '\0' && metres) {
        write_over_metres(of_values, text, size);
      } else if (of_values[0] != '\0') {
        snprintf(text, size, "%s%sgrid units", strcmp(of_values, "1") == 0 ? "" : of_values, strcmp(of_values, "1") == 0 ? "" : " ");
      }
      break;
    case STRATUS_QUANTITY_MEAN:
    case STRATUS_QUANTITY_MAXIMUM:
      snprintf(text, size, "%s", of_values);
      break;
    case STRATUS_QUANTITY_CELLS:
    case STRATUS_QUANTITY_TRANSMITTANCE:
      snprintf(text, size, "1");
      break;
    case STRATUS_QUANTITY_LENGTH:
    case STRATUS_QUANTITY_MAXIMUM_DEPTH:
    case STRATUS_QUANTITY_TRANSMITTANCE_DEPTH:
      snprintf(text, size, "%s", metres ? "m" : "grid units");
      break;
    default:
      break;
  }
}
