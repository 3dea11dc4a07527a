"""TODO job"""
